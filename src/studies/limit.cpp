#include "stickslip/studies/limit.hpp"

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>

#include "stickslip/algebra/dense.hpp"
#include "studies.hpp"

namespace stickslip::studies {
namespace {

using Samples = std::span<const Sample>;

// d^q - e^q.
double gap(double d, double e, double q) { return std::pow(d, q) - std::pow(e, q); }

// Through all samples, with as many powers as that takes; the error is that of the samples.
Uncertain through(Samples samples, double first_power, double step) {
  const int n = static_cast<int>(samples.size());
  // Weights w with sum w = 1 and sum w delta^p = 0.
  algebra::Matrix<double> conditions(n, n);
  std::vector<double> weights(samples.size(), 0.0);
  weights[0] = 1;
  for (int s = 0; s < n; ++s) {
    conditions(0, s) = 1;
    const double d = samples[s].at / samples.back().at;
    for (int m = 1; m < n; ++m) conditions(m, s) = std::pow(d, first_power + (m - 1) * step);
  }
  algebra::LuFactors(std::move(conditions)).solve(weights, false);
  Uncertain limit{0, 0};
  for (int s = 0; s < n; ++s) {
    limit.value += weights[s] * samples[s].value;
    limit.error += std::abs(weights[s]) * samples[s].error;
  }
  return limit;
}

// Through as many of the last samples as make the error smallest. It compares with the limit
// without the last sample and, if `shorter`, with the one of a power less.
Uncertain best_through(Samples samples, double first_power, double step, bool shorter) {
  Uncertain best{kNone, kNone};
  for (std::size_t n = 2; n < samples.size(); ++n) {
    const Uncertain now = through(samples.last(n), first_power, step);
    const auto distance = [&](Samples others) {
      return std::abs(now.value - through(others, first_power, step).value);
    };
    double change = distance(samples.last(n + 1).first(n));
    if (shorter) change = std::max(change, distance(samples.last(n - 1)));
    if (!(change + now.error >= best.error)) best = {now.value, change + now.error};
  }
  return best;
}

Uncertain by_observed_order(Samples samples, double order) {
  const auto from_two = [](const Sample& b, const Sample& c, double q) {
    return c.value - (b.value - c.value) * std::pow(c.at, q) / gap(b.at, c.at, q);
  };
  const std::size_t n = samples.size();
  const double before = observed_order(samples.first(n - 1));
  const double now = from_two(samples[n - 2], samples[n - 1], order);
  return {now, std::abs(now - from_two(samples[n - 3], samples[n - 2], before))};
}

}  // namespace

// (a - b)/(b - c) = (d_a^q - d_b^q)/(d_b^q - d_c^q).
double observed_order(Samples samples) {
  if (samples.size() < 3) return kNone;
  const Samples last = samples.last(3);
  const Sample &a = last[0], &b = last[1], &c = last[2];
  const double ratio = (a.value - b.value) / (b.value - c.value);
  const auto defect = [&](double q) {
    return std::log(gap(a.at, b.at, q) / gap(b.at, c.at, q)) - std::log(ratio);
  };
  constexpr double low = 0.05, high = 8;
  const bool changes = std::abs(b.value - c.value) > b.error + c.error;
  if (!changes || !(ratio > 0) || !(defect(low) * defect(high) <= 0)) return kNone;
  std::uintmax_t iterations = 100;
  const auto root = boost::math::tools::toms748_solve(
      defect, low, high, boost::math::tools::eps_tolerance<double>(40), iterations);
  return root.first;
}

Uncertain limit_of(Samples samples, double order, bool grazing) {
  if (std::isnan(order)) return {kNone, kNone};
  double first_power = 1;
  if (grazing) first_power = order < 1.75 ? 1.5 : 2;
  if (std::abs(order - first_power) > 0.25) return by_observed_order(samples, order);
  return best_through(samples, first_power, grazing ? 0.5 : 1, false);
}

Uncertain limit_in_half_powers(Samples samples) {
  const Uncertain none{kNone, kNone};
  if (samples.size() < 3) return none;
  const Samples last = samples.last(3);
  const double before = std::abs(last[1].value - last[0].value),
               change = std::abs(last[2].value - last[1].value);
  if (change > before + last[0].error + 2 * last[1].error + last[2].error) return none;
  return best_through(samples, 0.5, 0.5, true);
}

}  // namespace stickslip::studies
