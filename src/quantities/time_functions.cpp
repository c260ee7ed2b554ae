#include "stickslip/quantities/time_functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <numeric>

#include "stickslip/exact/transfer_function.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {
namespace {

// Waves that few levels hardly damp lie to the right of a contour beyond some 0.8 points / t. With
// a Laplace transform that falls as 1/z^2 there, the wide contour loses about what the two differ
// by; three times that stands for it, as waves come with any phase. Wider ones multiply rounding by
// exp(0.17 points).
constexpr int kWide = 34, kNarrow = 24;
constexpr double kDoubt = 3;

/// Points and weights of sum Re w F(z) for t = 1, upper half of Talbot's contour.
struct Contour {
  std::vector<std::complex<double>> z, weight;

  explicit Contour(int points) {
    constexpr double a = 0.5017, b = 0.6407, c = 0.6122, d = 0.2645;
    for (int n = points / 2; n < points; ++n) {
      const double theta = std::numbers::pi * (2.0 * n + 1 - points) / points;
      const double sine = std::sin(b * theta), cotangent = std::cos(b * theta) / sine;
      const std::complex<double> point(a * theta * cotangent - c, d * theta);
      const std::complex<double> slope(a * cotangent - a * b * theta / (sine * sine), d);
      z.push_back(static_cast<double>(points) * point);
      // exp(z) dz/(2 pi i), doubled for the lower half
      weight.push_back(2.0 * std::exp(z.back()) * slope * std::complex<double>(0, -1));
    }
  }
};

// An error dH of the transfer function is one of its inverse at the time t,
//
//   |df| <= (e/pi) int |dH((1 + i y)/t)| dy/t,  y >= 0,
//
// which three points of this line stand for, up to where the contour reaches. Models of rough ends
// miss most there of what is over long before t; without kinks that has the first two.
void add_points(const std::vector<Fold>& folds, const std::vector<double>& time,
                ReducedModel::Nature nature, Questions& questions) {
  std::vector<std::pair<double, double>> line{{0, 1}, {2, 2}};
  if (nature != ReducedModel::Nature::rough) line.emplace_back(14, 24);
  struct Place {
    std::complex<double> z;
    std::size_t time;
    double width;
  };
  std::vector<Place> places;
  for (std::size_t n = 0; n < time.size(); ++n) {
    for (const auto& [y, width] : line) {
      places.push_back({std::complex<double>(1, y) / time[n], n, width / time[n]});
    }
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return std::abs(a.z) < std::abs(b.z); });
  questions.terms.resize(folds.size() * time.size());
  for (const Place& place : places) {
    for (std::size_t f = 0; f < folds.size(); ++f) {
      const double weight = std::numbers::e / std::numbers::pi * place.width /
                            (std::pow(std::abs(place.z), folds[f].n) * folds[f].unit);
      questions.terms[f * time.size() + place.time].push_back({questions.points.size(), weight});
    }
    questions.points.push_back(place.z);
  }
}

}  // namespace

std::vector<std::vector<Uncertain>>
evaluate(const Reduced& reduced, const std::vector<double>& time, const std::vector<int>& folds) {
  static const std::array<Contour, 2> contours{Contour(kWide), Contour(kNarrow)};
  const exact::TransferFunction transfer(reduced.m, reduced.gamma, reduced.beta);
  std::vector<std::vector<Uncertain>> values(folds.size());
  for (double t : time) {
    std::vector<std::array<double, 2>> found(folds.size(), {0, 0});
    for (std::size_t k = 0; k < contours.size(); ++k) {
      const auto& [points, weights] = contours[k];
      for (std::size_t n = 0; n < points.size(); ++n) {
        const auto z = points[n] / t;
        const auto term = weights[n] * transfer(z) / t;
        for (std::size_t f = 0; f < folds.size(); ++f) {
          found[f][k] += (folds[f] == 0 ? term : term / std::pow(z, folds[f])).real();
        }
      }
    }
    for (std::size_t f = 0; f < folds.size(); ++f) {
      values[f].push_back({found[f][0], kDoubt * std::abs(found[f][1] - found[f][0])});
    }
  }
  return values;
}

TimeScales time_scales(const model::Process& process) {
  // At a typical speed friction and drag take the power that white noise gives.
  const auto force = [&](double v) {
    return process.friction.at_rest() - std::abs(process.bias) - process.drag(v);
  };
  const double scale = process.noise.intensity() / process.noise.standard_deviation();
  double low = 1e-9 * scale, high = 1e9 * scale;
  for (int n = 0; n < 60; ++n) {
    const double v = std::sqrt(low * high);
    (v * force(v) < process.noise.intensity() ? low : high) = v;
  }
  return {process.noise.correlation_time(), process.noise.rate(), low / force(low)};
}

TimeCurve time_curve(Pencil& pencil, const Ends& ends, ReducedModel::Nature nature,
                     const std::vector<Fold>& folds, const std::vector<double>& time,
                     const TimeScales& scales, double tolerance, Recipe& recipe) {
  constexpr int most_pairs = 120;
  std::vector<double> later;
  std::copy_if(time.begin(), time.end(), std::back_inserter(later), [](double t) { return t > 0; });
  ReducedModel model(pencil, ends, nature, most_pairs);
  std::vector<int> orders;
  for (const Fold& fold : folds) orders.push_back(fold.n);
  Questions questions;
  questions.values = [&](const Reduced& reduced) {
    const auto found = evaluate(reduced, later, orders);
    std::vector<Uncertain> values;
    for (std::size_t f = 0; f < folds.size(); ++f) {
      for (Uncertain value : found[f]) values.push_back(1 / folds[f].unit * value);
    }
    return values;
  };
  add_points(folds, later, nature, questions);
  for (std::size_t n = 0; n < folds.size() * later.size(); ++n) {
    questions.shift.push_back(2 / std::max(later[n % later.size()], 1e-6 * scales.correlation));
  }
  questions.tolerance = tolerance;
  questions.highest = 1e6 / scales.correlation;
  // From the slowest rates to beyond the rate of the noise. Under fast noise velocities are slower
  // than it by any factor, and long times depend on them.
  const auto [tau, rate, stopping] = scales;
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
    questions.first.push_back({low * std::pow(high / low, n / (shifts - 1.0)), 3});
  }
  TimeCurve curve;
  Answers answers;
  if (!later.empty()) {
    const bool smooth = nature == ReducedModel::Nature::smooth;
    answers = smooth ? ask(model, questions, recipe) : until_still(model, questions, recipe);
  }
  curve.pairs = answers.pairs;
  auto value = answers.value.begin(), error = answers.error.begin();
  for (const Fold& fold : folds) {
    auto& values = curve.value.emplace_back();
    for (double t : time) {
      if (t > 0) {
        values.push_back({fold.unit * *value++, fold.unit * *error++});
      } else {
        values.push_back({fold.n > 0 ? 0 : petsc::dot(ends.c, ends.b), 0});
      }
    }
  }
  return curve;
}

}  // namespace stickslip::quantities
