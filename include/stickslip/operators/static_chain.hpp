#pragma once
/// The static phase: the noise chain on a range of levels, killed when it leaves.

#include <span>
#include <vector>

#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::operators {

/// lambda - Q on the levels low <= i <= high, tridiagonal, factored once.
///
/// All members use the elimination of Grassmann, Taksar and Heyman on (jump rates, killing rate)
/// instead of (diagonal, off-diagonals): rates are only added, multiplied and divided, never
/// subtracted. Results have full relative accuracy in every entry, whatever the time scale (mean
/// sticking times of 1e20 included), if what they are asked about is >= 0. Local, O(levels).
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
  /// between i and -i would cancel. Empty for k = 0.
  [[nodiscard]] static StaticChain odd(const model::NoiseChain& chain, int k, double lambda = 0) {
    return {chain, 1, k, lambda};
  }

  /// m with m (lambda - Q) = entry: discounted mean time spent on each level by a sticking phase
  /// that starts on level low + n with probability entry[n] [time].
  [[nodiscard]] std::vector<double> occupation(std::span<const double> entry) const;

  /// u with (lambda - Q) u = f: the discounted integral of f over a sticking phase, by its first
  /// level.
  [[nodiscard]] std::vector<double> integral(std::vector<double> f) const;

  /// E_i[exp(-lambda T)], T the time of leaving: on both sides, or on one of them only.
  [[nodiscard]] std::vector<double> exit_transform() const;
  [[nodiscard]] std::vector<double> upward_exit_transform() const;
  [[nodiscard]] std::vector<double> downward_exit_transform() const;

  /// Rate of leaving upwards from the highest level.
  [[nodiscard]] double exit_rate() const { return up_exit_; }

  [[nodiscard]] int size() const { return static_cast<int>(pivot_.size()); }

 private:
  StaticChain(const model::NoiseChain& chain, int low, int high, double lambda);

  std::vector<double> up_, down_;  // jump rates inside the chain
  std::vector<double> pivot_;      // of the elimination from the lowest level upwards
  double up_exit_ = 0, down_exit_ = 0;
};

}  // namespace stickslip::operators
