#include "stickslip/simulation/means.hpp"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "stickslip/base/text.hpp"
#include "stickslip/base/uncertain.hpp"

namespace stickslip::simulation {

void Comoments::merge(std::span<const double> others) {
  const double more = others[0];
  if (more == 0) return;
  const double total = count() + more, share = more / total;
  const double weight = count() * share;
  for (std::size_t n = 0; n < size_; ++n) deviation_[n] = others[1 + n] - mean(n);
  std::size_t at = 1 + size_;
  for (std::size_t r = 0; r < size_; ++r) {
    for (std::size_t c = 0; c <= r; ++c, ++at) {
      numbers_[at] += others[at] + weight * deviation_[r] * deviation_[c];
    }
    numbers_[1 + r] += deviation_[r] * share;
  }
  numbers_[0] = total;
}

double Comoments::variance_of_mean(std::span<const double> weight) const {
  if (count() < 2) return kInfinity;
  double sum = 0;
  std::size_t at = 1 + size_;
  for (std::size_t r = 0; r < size_; ++r) {
    for (std::size_t c = 0; c <= r; ++c, ++at) {
      sum += (c < r ? 2 : 1) * weight[r] * weight[c] * numbers_[at];
    }
  }
  return std::max(sum, 0.0) / (count() * (count() - 1));
}

namespace {

using Complex = Smooth::Complex;

std::valarray<Complex> sum(const Smooth& a, Complex by_a, const Smooth& b, Complex by_b) {
  if (b.slope.size() == 0) return a.slope * by_a;
  if (a.slope.size() == 0) return b.slope * by_b;
  return a.slope * by_a + b.slope * by_b;
}

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

// Numbers, and shares of all, of alike samples that would have the variance of a mean beside zeros.
// Where they are fewer, the variance itself is hardly known: rare samples may be missing in it.
constexpr double kFewCarry = 20, kFewOfAll = 0.1;

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

Smooth operator+(const Smooth& a, const Smooth& b) { return {a.value + b.value, sum(a, 1, b, 1)}; }
Smooth operator-(const Smooth& a, const Smooth& b) { return {a.value - b.value, sum(a, 1, b, -1)}; }
Smooth operator*(const Smooth& a, const Smooth& b) {
  return {a.value * b.value, sum(a, b.value, b, a.value)};
}
Smooth operator/(const Smooth& a, const Smooth& b) {
  const Complex value = a.value / b.value;
  return {value, sum(a, 1.0 / b.value, b, -value / b.value)};
}

Smooth Means::at(std::size_t side, std::size_t n, double parity) const {
  if (symmetric() && side == 1) return parity * at(0, n);
  std::valarray<Complex> slope(Complex(0), sides_.size() * sides_[0].size());
  slope[side * sides_[0].size() + n] = 1;
  return {sides_[side].mean(n), slope};
}

Smooth Means::complex_at(std::size_t side, std::size_t n, double parity) const {
  const Smooth imaginary = at(side, n + 1, parity);
  const Complex i(0, 1);
  return at(side, n, parity) + Smooth(i * imaginary.value, imaginary.slope * i);
}

Smooth Means::share(std::size_t side) const {
  return symmetric() ? Smooth(0.5) : at(1 - side, 0) / (at(0, 0) + at(1, 0));
}

Smooth Means::overall(std::size_t n, double parity) const {
  if (cycles()) return at(0, n) / at(0, 0);
  return share(0) * at(0, n) + share(1) * at(1, n, parity);
}

double Means::variance(const Smooth& f) const {
  double variance = 0;
  std::vector<double> weight(sides_[0].size());
  for (std::size_t side = 0; side < sides_.size() && f.slope.size() > 0; ++side) {
    for (std::size_t n = 0; n < weight.size(); ++n) {
      weight[n] = f.slope[side * weight.size() + n].real();
    }
    variance += sides_[side].variance_of_mean(weight);
  }
  return variance;
}

Estimate Means::estimate(const Smooth& f) const {
  const double half = kNormalQuantile * std::sqrt(variance(f)), value = f.value.real();
  return {value, value - half, value + half};
}

double Means::missed(std::size_t side, std::size_t n) const {
  const Comoments& of = sides_[side];
  std::vector<double> weight(of.size());
  weight[n] = 1;
  const double p = of.mean(n), variance = of.variance_of_mean(weight);
  const double few = std::min(kFewCarry, kFewOfAll * of.count());
  if (!(p < 1) || (p > 0 && p * p >= few * variance)) return 0;
  const double half = proportion(p * of.count(), of.count()).high - p;
  return std::max(0.0, half - kNormalQuantile * std::sqrt(variance));
}

Estimate Means::estimate(const Smooth& f, const std::vector<std::size_t>& shares) const {
  Estimate e = estimate(f);
  const std::size_t size = sides_[0].size();
  for (std::size_t at = 0; at < f.slope.size(); ++at) {
    const double slope = std::abs(f.slope[at].real());
    if (slope == 0 || std::ranges::find(shares, at % size) == shares.end()) continue;
    const double more = slope * missed(at / size, at % size);
    e.low -= more;
    e.high += more;
  }
  return e;
}

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
