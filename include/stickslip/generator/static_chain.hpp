#pragma once
/// The static phase: the noise chain on a range of levels, killed when it leaves.

#include <map>
#include <span>
#include <vector>

#include "stickslip/linalg/dense.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::generator {

/// lambda - Q on the levels low <= i <= high, factored once, without subtraction: see
/// linalg::RateElimination, whose accuracy holds for mean sticking times of 1e20 too. Local,
/// O(levels) where the noise jumps to neighbours alone.
class StaticChain {
 public:
  /// The static levels |i| <= k; lambda >= 0 [1/time]; the noise must have others.
  StaticChain(const model::NoiseChain& chain, int k, double lambda = 0)
      : StaticChain(chain, -k, k, lambda) {}
  /// The static levels of a process, with its bias.
  [[nodiscard]] static StaticChain of(const model::Process& process, double lambda = 0) {
    return {process.noise, process.lowest_static(), process.highest_static(), lambda};
  }

  /// The levels 1 <= i <= k, killed on reaching 0: where odd functions live, whose differences
  /// between i and -i would cancel. Empty for k = 0. Of chains that jump to neighbours.
  [[nodiscard]] static StaticChain odd(const model::NoiseChain& chain, int k, double lambda = 0) {
    return {chain, 1, k, lambda};
  }

  /// m with m (lambda - Q) = entry: discounted mean time spent on each level by a sticking phase
  /// that starts on level low + n with probability entry[n] [time].
  [[nodiscard]] std::vector<double> occupation(std::span<const double> entry) const {
    return rates_.occupation(entry);
  }

  /// u with (lambda - Q) u = f: the discounted integral of f over a sticking phase, by its first
  /// level.
  [[nodiscard]] std::vector<double> integral(std::vector<double> f) const {
    return rates_.integral(std::move(f));
  }

  /// E_i[exp(-lambda T)], T the time of leaving: on both sides, on one of them only, or to one
  /// level.
  [[nodiscard]] std::vector<double> exit_transform() const;
  [[nodiscard]] std::vector<double> upward_exit_transform() const;
  [[nodiscard]] std::vector<double> downward_exit_transform() const;
  [[nodiscard]] std::vector<double> exit_transform_to(int level) const;

  [[nodiscard]] int size() const { return rates_.size(); }

 private:
  StaticChain(const model::NoiseChain& chain, int low, int high, double lambda);
  // E_i[exp(-lambda T)] for leaving to levels of which `counts` is true.
  template <class Counts>
  [[nodiscard]] std::vector<double> transform(Counts counts) const;

  int high_;
  linalg::RateElimination rates_;
  std::map<int, std::vector<double>> exits_;  // rates of jumps to levels beyond, by these
};

}  // namespace stickslip::generator
