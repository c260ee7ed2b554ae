#include "stickslip/simulation/path_bins.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/simulation/histogram.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::simulation {
namespace {

constexpr double kSmallest = 1e-8, kLargest = 1e5;  // sizes of y in units of the scale
constexpr std::size_t kKept = 3;

// Two samples of the same count, mean and mean square of the weight, which the co-moments do not
// tell from all.
void add_group(Comoments& all, double turned, double within,
               const std::array<double, kKept>& sums) {
  const auto [count, weight, square] = sums;
  if (count == 0) return;
  const double mean = weight / count,
               deviation = std::sqrt(std::max(square / count - mean * mean, 0.0));
  for (const double w : {mean - deviation, mean + deviation}) {
    all.add(std::array{turned, w, w * within}, count / 2);
  }
}

}  // namespace

PathBins::PathBins(Sampled sampled, bool both_signs, double scale, double step)
    : sampled_(sampled),
      scale_(kSmallest * scale),
      step_(step),
      side_bins_(static_cast<std::size_t>(std::asinh(kLargest / kSmallest) / step)),
      zero_(both_signs ? side_bins_ : 0),
      bins_(zero_ + 1 + side_bins_),
      numbers_((sampled == Sampled::sides ? 4 : 2) * bins_ * kKept) {}

void PathBins::add(std::size_t side, bool turned, double weight, double y) {
  std::size_t bin = zero_;
  if (y != 0) {
    const double away =
        std::min(1 + std::asinh(std::abs(y) / scale_) / step_, static_cast<double>(side_bins_));
    bin = y > 0 ? bin + static_cast<std::size_t>(away) : bin - static_cast<std::size_t>(away);
  }
  double* const sums = &numbers_[((2 * side + (turned ? 1 : 0)) * bins_ + bin) * kKept];
  sums[0] += 1;
  sums[1] += weight;
  sums[2] += weight * weight;
}

PathBins::Edges PathBins::edges(std::size_t bin) const {
  if (bin == zero_) return {0, 0};
  const std::size_t n = bin > zero_ ? bin - zero_ : zero_ - bin;
  const auto outer = static_cast<double>(n);
  const double low = scale_ * std::sinh((outer - 1) * step_),
               high = n == side_bins_ ? kInfinity : scale_ * std::sinh(outer * step_);
  return bin > zero_ ? Edges{low, high} : Edges{-high, -low};
}

Estimate PathBins::share_up_to(std::size_t bin) const {
  std::vector<Comoments> sides(sampled_ == Sampled::sides ? 2 : 1, Comoments(1 + 2));
  const double* next = numbers_.data();
  for (Comoments& side : sides) {
    for (const double turned : {0.0, 1.0}) {
      std::array<std::array<double, kKept>, 2> sums{};
      for (std::size_t n = 0; n < bins_; ++n) {
        for (double& sum : sums[n <= bin ? 1 : 0]) sum += *next++;
      }
      add_group(side, turned, 0, sums[0]);
      add_group(side, turned, 1, sums[1]);
    }
  }
  const Means means(sides, sampled_);
  return jeffreys(means, means.overall(2) / means.overall(1), 1, means.count());
}

std::size_t PathBins::first(double Estimate::*end, double p) const {
  std::size_t low = 0, high = bins_ - 1;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (share_up_to(middle).*end >= p) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

Estimate PathBins::quantile(double p) const {
  const std::size_t bin = first(&Estimate::value, p);
  const double before = bin > 0 ? share_up_to(bin - 1).value : 0, at = share_up_to(bin).value;
  const auto [low, high] = edges(bin);
  const double value = std::isinf(low)    ? high
                       : std::isinf(high) ? low
                                          : low + (high - low) * (p - before) / (at - before);
  return {value, edges(first(&Estimate::high, p)).low, edges(first(&Estimate::low, p)).high};
}

}  // namespace stickslip::simulation
