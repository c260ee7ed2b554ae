#pragma once
/// Quantiles of a number that paths have at their ends.

#include <cstddef>
#include <span>
#include <vector>

#include "stickslip/simulation/comoments.hpp"
#include "stickslip/simulation/means.hpp"

namespace stickslip::simulation {

/// Counts, weights and their squares of paths by side, by whether they turn, and by bin of a number
/// y. Bins are `step` |y| wide, from far below a scale to far above it on either side of 0, which
/// is a bin of its own. So memory is the same for any number of paths.
///
/// Intervals of quantiles hold for any distribution: they reach from the first bin up to whose end
/// there may be a probability of p, by Jeffreys' interval of the share, to the first one up to
/// whose end there is at least that. Local.
class PathBins {
 public:
  /// Of both signs of y, or of y >= 0 alone.
  PathBins(Sampled sampled, bool both_signs, double scale, double step);

  void add(std::size_t side, bool turned, double weight, double y);
  /// The y up to which there is the probability p. An end of the interval is infinite where too few
  /// samples are beyond. O(bins log bins).
  [[nodiscard]] Estimate quantile(double p) const;

  /// All that is kept, in a row.
  [[nodiscard]] std::span<double> numbers() { return numbers_; }
  [[nodiscard]] std::span<const double> numbers() const { return numbers_; }

 private:
  struct Edges {
    double low, high;
  };
  [[nodiscard]] Edges edges(std::size_t bin) const;
  /// The share of paths in the bins up to this one.
  [[nodiscard]] Estimate share_up_to(std::size_t bin) const;
  /// The first bin up to which a share, or an end of its interval, is p; the last one if none is.
  [[nodiscard]] std::size_t first(double Estimate::*end, double p) const;

  Sampled sampled_;
  double scale_, step_;
  std::size_t side_bins_, zero_, bins_;  // of one sign, the one of 0, all
  std::vector<double> numbers_;          // count, weight and its square by side, turned and bin
};

}  // namespace stickslip::simulation
