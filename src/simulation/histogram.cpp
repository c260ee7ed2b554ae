#include "stickslip/simulation/histogram.hpp"

#include <algorithm>
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

Histogram::Side Histogram::summary(std::size_t side, const Weight& weight) const {
  Side s;
  for (std::size_t n = 0; n < 2 * bins_; ++n) {
    const double count = counts_[2 * side * bins_ + n];
    s.count += count;
    s.turned += n >= bins_ ? count : 0;
    s.mean += count * weight(n % bins_);
  }
  s.turned /= s.count;
  s.mean /= s.count;
  return s;
}

double Histogram::variance(std::size_t side, const Weight& weight, double scale,
                           double by_turned) const {
  double count = 0, sum = 0, squares = 0;
  for (std::size_t n = 0; n < 2 * bins_; ++n) {
    const double here = counts_[2 * side * bins_ + n];
    const double value = scale * weight(n % bins_) + (n >= bins_ ? by_turned : 0);
    count += here;
    sum += here * value;
    squares += here * value * value;
  }
  return (squares - sum * sum / count) / (count * count);
}

Estimate Histogram::jeffreys(double mean, double variance, double count,
                             const Weight& weight) const {
  double largest = 0;
  for (std::size_t n = 0; n < bins_; ++n) largest = std::max(largest, weight(n));
  if (largest == 0) return {};
  const double p = std::min(1.0, mean / largest), v = variance / (largest * largest);
  const double certain = 1e-14 / count;  // where all weights are alike
  const double trials = v > certain ? p * (1 - p) / v : count;
  const Estimate e = proportion(p * trials, trials);
  return {mean, std::min(mean, largest * e.low), std::max(mean, largest * e.high)};
}

Estimate Histogram::mean(std::size_t side, const Weight& weight) const {
  const Side s = summary(side, weight);
  return jeffreys(s.mean, variance(side, weight, 1, 0), s.count, weight);
}

// a- M+ + a+ M- over a+ + a-, with M the means and a the shares of those that turn.
Estimate Histogram::mean(const Weight& weight) const {
  if (counts_.size() == 2 * bins_) return mean(0, weight);
  const std::array side{summary(0, weight), summary(1, weight)};
  const double turns = side[0].turned + side[1].turned;
  const double value = (side[1].turned * side[0].mean + side[0].turned * side[1].mean) / turns;
  double spread = 0;
  for (std::size_t s : {0, 1}) {
    const Side& other = side[1 - s];
    spread += variance(s, weight, other.turned / turns, (other.mean - value) / turns);
  }
  return jeffreys(value, spread, side[0].count, weight);
}

}  // namespace stickslip::simulation
