#pragma once
/// How many excursions fall into each of some bins.

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "stickslip/simulation/comoments.hpp"
#include "stickslip/simulation/means.hpp"

namespace stickslip::simulation {

/// Counts by the side from which an excursion starts, by whether it ends on the other one, and by
/// bin. With symmetry all start at s+.
class Histogram {
 public:
  Histogram(bool symmetric, std::size_t bins) : bins_(bins), counts_((symmetric ? 2 : 4) * bins) {}

  void add(std::size_t side, bool turned, std::size_t bin) {
    counts_[(2 * side + (turned ? 1 : 0)) * bins_ + bin] += 1;
  }
  [[nodiscard]] std::size_t bins() const { return bins_; }
  [[nodiscard]] std::span<double> counts() { return counts_; }
  [[nodiscard]] std::span<const double> counts() const { return counts_; }

  /// Mean of weight(bin) >= 0 over all excursions of a long path, or over those from one side.
  /// Jeffreys' interval for as many trials as give the variance of the delta method.
  using Weight = std::function<double(std::size_t bin)>;
  [[nodiscard]] Estimate mean(const Weight& weight) const;
  [[nodiscard]] Estimate mean(std::size_t side, const Weight& weight) const;

 private:
  /// Of 1{turned} and weight(bin) over the excursions from one side.
  [[nodiscard]] Comoments moments(std::size_t side, const Weight& weight) const;
  [[nodiscard]] Estimate jeffreys(std::span<const Comoments> sides, const Weight& weight) const;

  std::size_t bins_;
  std::vector<double> counts_;
};

}  // namespace stickslip::simulation
