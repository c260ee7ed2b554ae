#include "stickslip/quantities/time_functions.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "stickslip/exact/transfer_function.hpp"
#include "stickslip/petsc/check.hpp"

namespace stickslip::quantities {
namespace {

using petsc::check;

constexpr int kPoints = 24;
constexpr double kTalbotError = 1e-13;  // of the largest value

/// Points and weights of sum Re w F(z) for t = 1, upper half of the contour.
struct Contour {
  std::vector<std::complex<double>> z, weight;

  Contour() {
    constexpr double a = 0.5017, b = 0.6407, c = 0.6122, d = 0.2645;
    for (int n = kPoints / 2; n < kPoints; ++n) {
      const double theta = std::numbers::pi * (2.0 * n + 1 - kPoints) / kPoints;
      const double sine = std::sin(b * theta), cotangent = std::cos(b * theta) / sine;
      const std::complex<double> point(a * theta * cotangent - c, d * theta);
      const std::complex<double> slope(a * cotangent - a * b * theta / (sine * sine), d);
      z.push_back(static_cast<double>(kPoints) * point);
      // exp(z) dz/(2 pi i), doubled for the lower half
      weight.push_back(2.0 * std::exp(z.back()) * slope * std::complex<double>(0, -1));
    }
  }
};

}  // namespace

std::vector<std::vector<double>> evaluate(const Reduced& reduced, const std::vector<double>& time,
                                          const std::vector<int>& folds) {
  static const Contour contour;
  const exact::TransferFunction transfer(reduced.m, reduced.gamma, reduced.beta);
  std::vector<std::vector<double>> values(folds.size(), std::vector<double>(time.size(), 0.0));
  for (std::size_t at = 0; at < time.size(); ++at) {
    const double t = time[at];
    for (std::size_t n = 0; t > 0 && n < contour.z.size(); ++n) {
      const auto z = contour.z[n] / t;
      const auto term = contour.weight[n] * transfer(z) / t;
      for (std::size_t f = 0; f < folds.size(); ++f) {
        values[f][at] += (folds[f] == 0 ? term : term / std::pow(z, folds[f])).real();
      }
    }
    for (std::size_t f = 0; t == 0 && f < folds.size(); ++f) {
      if (folds[f] > 0) continue;
      values[f][at] =
          std::inner_product(reduced.gamma.begin(), reduced.gamma.end(), reduced.beta.begin(), 0.0);
    }
  }
  return values;
}

TimeScales time_scales(const model::Process& process) {
  // At a typical speed friction and drag take the power that white noise gives.
  const auto force = [&](double v) {
    return process.friction.at_rest() - std::abs(process.bias) - process.drag(v);
  };
  double low = 1e-9, high = 1e9;
  for (int n = 0; n < 60; ++n) {
    const double v = std::sqrt(low * high);
    (v * force(v) < process.noise.intensity() ? low : high) = v;
  }
  return {process.noise.correlation_time(), process.noise.rate(), low / force(low)};
}

TimeCurve time_curve(Pencil& pencil, const Ends& ends, ReducedModel::Nature nature,
                     const std::vector<Fold>& folds, const std::vector<double>& time,
                     const TimeScales& scales, double tolerance) {
  constexpr int most_pairs = 80;
  ReducedModel model(pencil, ends, nature, most_pairs);
  std::vector<int> orders;
  for (const Fold& fold : folds) orders.push_back(fold.n);
  Questions questions;
  questions.values = [&](const Reduced& reduced) {
    const auto found = evaluate(reduced, time, orders);
    std::vector<double> values;
    for (std::size_t f = 0; f < folds.size(); ++f) {
      for (double value : found[f]) values.push_back(value / folds[f].unit);
    }
    return values;
  };
  const auto [tau, rate, stopping] = scales;
  for (std::size_t n = 0; n < folds.size() * time.size(); ++n) {
    questions.shift.push_back(2 / std::max(time[n % time.size()], 1e-6 * tau));
  }
  questions.tolerance = tolerance;
  // From the slowest rates to beyond the rate of the noise. Under fast noise velocities are slower
  // than it by any factor, and long times depend on them.
  const double longest = *std::max_element(time.begin(), time.end());
  double low = 0.3 / tau;
  const double high = std::max(30 / tau, 12 * rate);
  int shifts = 6;
  questions.lowest = 0.05 / tau;
  const double slowest = std::max(2 / longest, 0.05 / stopping);
  if (slowest < questions.lowest) {
    shifts += static_cast<int>(std::ceil(std::log10(low / slowest)));
    low = slowest;
    questions.lowest = 0.5 * slowest;
  }
  for (int n = 0; n < shifts; ++n) {
    questions.first_shifts.push_back(low * std::pow(high / low, n / (shifts - 1.0)));
  }
  questions.highest = 1e6 / tau;
  Answers answers = ask(model, questions);
  PetscInt size = 0;
  check(VecGetSize(ends.b, &size));
  // Few levels of the noise leave little to reduce, and functions that no reduced model follows.
  constexpr PetscInt small = 400;
  if (answers.relative_error > tolerance && size <= small) {
    answers.value = questions.values(whole_model(pencil, ends, true));
    const auto other = questions.values(whole_model(pencil, ends, false));
    for (std::size_t n = 0; n < other.size(); ++n) {
      answers.error[n] = std::abs(other[n] - answers.value[n]) + kTalbotError;
    }
  }
  TimeCurve curve;
  curve.pairs = answers.pairs;
  auto value = answers.value.begin(), error = answers.error.begin();
  for (const Fold& fold : folds) {
    auto& values = curve.value.emplace_back();
    for (std::size_t n = 0; n < time.size(); ++n) {
      values.push_back({fold.unit * *value++, fold.unit * *error++});
    }
  }
  return curve;
}

}  // namespace stickslip::quantities
