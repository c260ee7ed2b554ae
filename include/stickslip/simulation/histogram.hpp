#pragma once
/// How many excursions have a number between edges.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "stickslip/simulation/comoments.hpp"
#include "stickslip/simulation/means.hpp"

namespace stickslip::simulation {

/// The mean of numbers from 0 to `largest`, from `count` samples: Jeffreys' interval for as many
/// trials as give the variance of the delta method.
[[nodiscard]] Estimate jeffreys(const Means& means, const Smooth& mean, double largest,
                                double count);

/// Counts by the side from which an excursion starts, by whether it ends on the other one, and by
/// bin, of which the n-th is below the n-th of the rising edges. With symmetry all start at s+.
class Histogram {
 public:
  Histogram(bool symmetric, std::vector<double> edges)
      : edges_(std::move(edges)), bins_(edges_.size() + 1), counts_((symmetric ? 2 : 4) * bins_) {}

  void add(std::size_t side, bool turned, double value) {
    counts_[(2 * side + (turned ? 1 : 0)) * bins_ + bin(value)] += 1;
  }
  [[nodiscard]] std::span<double> counts() { return counts_; }
  [[nodiscard]] std::span<const double> counts() const { return counts_; }

  /// Mean of weight(bin) >= 0 over all excursions of a long path, or over those from one side.
  using Weight = std::function<double(std::size_t bin)>;
  [[nodiscard]] Estimate mean(const Weight& weight) const;
  [[nodiscard]] Estimate mean(std::size_t side, const Weight& weight) const;
  /// Probability of low <= value < high; low and high are edges, or 0 and infinity.
  [[nodiscard]] Estimate probability(double low, double high) const;

 private:
  [[nodiscard]] std::size_t bin(double value) const {
    const auto above = std::upper_bound(edges_.begin(), edges_.end(), value);
    return static_cast<std::size_t>(above - edges_.begin());
  }
  /// Of 1{turned} and weight(bin) over the excursions from one side.
  [[nodiscard]] Comoments moments(std::size_t side, const Weight& weight) const;
  [[nodiscard]] Estimate jeffreys(std::span<const Comoments> sides, const Weight& weight) const;

  std::vector<double> edges_;
  std::size_t bins_;
  std::vector<double> counts_;
};

}  // namespace stickslip::simulation
