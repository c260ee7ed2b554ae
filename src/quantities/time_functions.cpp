#include "stickslip/quantities/time_functions.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "stickslip/exact/transfer_function.hpp"

namespace stickslip::quantities {
namespace {

constexpr int kPoints = 24;

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

TimeFunction evaluate(const Reduced& reduced, const std::vector<double>& time) {
  static const Contour contour;
  const exact::TransferFunction transfer(reduced.m, reduced.gamma, reduced.beta);
  TimeFunction f;
  for (double t : time) {
    double value = 0, integral = 0;
    if (t == 0) {
      for (std::size_t n = 0; n < reduced.beta.size(); ++n) {
        value += reduced.gamma[n] * reduced.beta[n];
      }
    }
    for (std::size_t n = 0; t > 0 && n < contour.z.size(); ++n) {
      const auto z = contour.z[n] / t;
      const auto term = contour.weight[n] * transfer(z) / t;
      value += term.real();
      integral += (term / z).real();
    }
    f.value.push_back(value);
    f.integral.push_back(integral);
  }
  return f;
}

TimeCurve time_curve(operators::Systems& systems, operators::KolmogorovOperator minus_l,
                     operators::StaticPhase rest, const Ends& ends, ReducedModel::Nature nature,
                     Integral integral, const std::vector<double>& time, double unit,
                     double tolerance) {
  constexpr int most_pairs = 80;
  ReducedModel model(systems, std::move(minus_l), rest, ends, nature, most_pairs);
  Questions questions;
  questions.values = [&](const Reduced& reduced) {
    const TimeFunction f = evaluate(reduced, time);
    std::vector<double> values;
    for (double value : f.value) values.push_back(value / unit);
    if (integral == Integral::wanted) {
      values.insert(values.end(), f.integral.begin(), f.integral.end());
    }
    return values;
  };
  const double tau = systems.process().noise.correlation_time();
  for (std::size_t n = 0; n < 2 * time.size(); ++n) {
    questions.shift.push_back(2 / std::max(time[n % time.size()], 1e-6 * tau));
  }
  questions.tolerance = tolerance;
  // From the slowest rates to beyond the rate of the noise.
  constexpr int shifts = 6;
  const double low = 0.3 / tau, high = std::max(30 / tau, 12 * systems.process().noise.rate());
  for (int n = 0; n < shifts; ++n) {
    questions.first_shifts.push_back(low * std::pow(high / low, n / (shifts - 1.0)));
  }
  questions.lowest = 0.05 / tau;
  questions.highest = 1e6 / tau;
  const Answers answers = ask(model, questions);
  TimeCurve curve;
  curve.pairs = answers.pairs;
  for (std::size_t n = 0; n < time.size(); ++n) {
    const std::size_t m = time.size() + n;
    curve.value.push_back({unit * answers.value[n], unit * answers.error[n]});
    if (m < answers.value.size()) {
      curve.integral.push_back({answers.value[m], answers.error[m]});
    }
  }
  return curve;
}

}  // namespace stickslip::quantities
