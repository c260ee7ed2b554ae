#include "stickslip/studies/limit.hpp"

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
Limit through(Samples samples, double first_power, double step) {
  const int n = static_cast<int>(samples.size());
  // Weights w with sum w = 1 and sum w delta^p = 0.
  algebra::Matrix<double> conditions(n, n);
  std::vector<double> weights(samples.size(), 0.0);
  weights[0] = 1;
  for (int s = 0; s < n; ++s) {
    conditions(0, s) = 1;
    const double d = samples[s].delta / samples.back().delta;
    for (int m = 1; m < n; ++m) conditions(m, s) = std::pow(d, first_power + (m - 1) * step);
  }
  algebra::LuFactors(std::move(conditions)).solve(weights, false);
  Limit limit{0, 0};
  for (int s = 0; s < n; ++s) {
    limit.value += weights[s] * samples[s].value;
    limit.error += std::abs(weights[s]) * samples[s].error;
  }
  return limit;
}

Limit by_observed_order(Samples samples, double order) {
  const auto from_two = [](const Sample& b, const Sample& c, double q) {
    return c.value - (b.value - c.value) * std::pow(c.delta, q) / gap(b.delta, c.delta, q);
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
    return std::log(gap(a.delta, b.delta, q) / gap(b.delta, c.delta, q)) - std::log(ratio);
  };
  constexpr double low = 0.05, high = 8;
  if (!(ratio > 0) || defect(low) * defect(high) > 0) return kNone;
  std::uintmax_t iterations = 100;
  const auto root = boost::math::tools::toms748_solve(
      defect, low, high, boost::math::tools::eps_tolerance<double>(40), iterations);
  return root.first;
}

Limit limit_of(Samples samples, double order, bool grazing) {
  if (std::isnan(order)) return {kNone, kNone};
  double first_power = 1;
  if (grazing) first_power = order < 1.75 ? 1.5 : 2;
  if (std::abs(order - first_power) > 0.25) return by_observed_order(samples, order);
  const double step = grazing ? 0.5 : 1;
  Limit best{kNone, kNone};
  for (std::size_t n = 2; n < samples.size(); ++n) {
    const Limit now = through(samples.last(n), first_power, step);
    const Limit before = through(samples.last(n + 1).first(n), first_power, step);
    const double error = std::abs(now.value - before.value) + now.error;
    if (!(error >= best.error)) best = {now.value, error};
  }
  return best;
}

}  // namespace stickslip::studies
