#include "stickslip/simulation/histogram.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>

namespace stickslip::simulation {
namespace {

Estimate proportion(double successes, double trials) {
  using Binomial = boost::math::binomial_distribution<double>;
  constexpr auto kind = Binomial::jeffreys_prior_interval;
  constexpr double tail = 0.025;
  const double low =
      successes <= 0 ? 0 : Binomial::find_lower_bound_on_p(trials, successes, tail, kind);
  const double high =
      successes >= trials ? 1 : Binomial::find_upper_bound_on_p(trials, successes, tail, kind);
  return {successes / trials, low, high};
}

}  // namespace

Comoments Histogram::moments(std::size_t side, const Weight& weight) const {
  Comoments moments(2);
  for (std::size_t n = 0; n < 2 * bins_; ++n) {
    const double count = counts_[2 * side * bins_ + n];
    if (count > 0) moments.add(std::array{n < bins_ ? 0.0 : 1.0, weight(n % bins_)}, count);
  }
  return moments;
}

Estimate jeffreys(const Means& means, const Smooth& of_weight, double largest, double count) {
  const double mean = of_weight.value.real();
  const double variance = count > 1 ? means.variance(of_weight) * (count - 1) / count : 0;
  const double p = std::min(1.0, mean / largest), v = variance / (largest * largest);
  const double certain = 1e-14 / count;  // where all weights are alike
  const double trials = v > certain ? p * (1 - p) / v : count;
  const Estimate e = proportion(p * trials, trials);
  return {mean, std::min(mean, largest * e.low), std::max(mean, largest * e.high)};
}

Estimate Histogram::jeffreys(std::span<const Comoments> sides, const Weight& weight) const {
  double largest = 0;
  for (std::size_t n = 0; n < bins_; ++n) largest = std::max(largest, weight(n));
  if (largest == 0) return {};
  const Means means(sides, sides.size() == 1 ? Sampled::one_side : Sampled::sides);
  return simulation::jeffreys(means, means.overall(1), largest, sides[0].count());
}

Estimate Histogram::mean(std::size_t side, const Weight& weight) const {
  return jeffreys(std::array{moments(side, weight)}, weight);
}

Estimate Histogram::mean(const Weight& weight) const {
  if (counts_.size() == 2 * bins_) return mean(0, weight);
  return jeffreys(std::array{moments(0, weight), moments(1, weight)}, weight);
}

Estimate Histogram::probability(double low, double high) const {
  const std::size_t first = low > 0 ? bin(low) : 0, last = std::isfinite(high) ? bin(high) : bins_;
  return mean([&](std::size_t n) { return first <= n && n < last ? 1.0 : 0.0; });
}

}  // namespace stickslip::simulation
