#include <algorithm>
#include <cmath>

#include "averages.hpp"
#include "routes.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/check.hpp"

namespace stickslip::routes {
namespace {

using operators::Rest;
using operators::Symmetry;
using petsc::check;
using quantities::Uncertain;

constexpr int kAttempts = 4;
constexpr double kSmallest = 1e-15;  // of 1/tau
constexpr int kMostSolves = 6;

struct Averaged {
  std::vector<Uncertain> values;  // errors: rounding and bias
  double largest_bias = 0;        // relative
};

/// R = (lambda - M)^-1 read at s+.
class FullGrid {
 public:
  FullGrid(const Setting& setting, double lambda)
      : lambda_(lambda),
        systems_(setting.comm, setting.process, setting.axis, setting.ledger),
        system_(systems_.at(lambda, Symmetry::none, Rest::kept)),
        at_exit_(system_.a().trace_at_exit()) {}

  struct Mean {
    Uncertain value;
    double bias;
  };
  /// c = R f/R 1 at s+ as the root of R(f - c) = 0, see by_lambda.
  [[nodiscard]] Mean of(const operators::KolmogorovOperator::Observable& f) {
    const petsc::VecHandle rest = system_.a().values(f);
    double c = 0, last = 0;
    petsc::Solution u;
    Uncertain step;
    for (int n = 0; n < kMostSolves; ++n) {
      check(VecShift(rest, -last));
      u = system_.factors().solve(rest);
      step = lambda_ * quantities::value_of(at_exit_, u);
      c += step.value;
      if (std::abs(step.value) <= 1e-15 * std::abs(c)) break;
      last = step.value;
    }
    const petsc::Solution twice = system_.factors().solve(u.x);
    const double bias = lambda_ * lambda_ * quantities::value_of(at_exit_, twice).value;
    return {{c, std::abs(step.value) + step.error + std::abs(bias)}, std::abs(bias)};
  }

 private:
  double lambda_;
  operators::Systems systems_;
  operators::System& system_;
  petsc::VecHandle at_exit_;
};

Averaged average_at(const Setting& setting, double lambda) {
  FullGrid grid(setting, lambda);
  Averaged result;
  for (const auto& average : averages(setting)) {
    const auto mean = grid.of(average.f.value);
    result.values.push_back(mean.value);
    result.largest_bias = std::max(result.largest_bias, mean.bias / std::abs(mean.value.value));
  }
  return result;
}

}  // namespace

Evaluation by_lambda(const Setting& setting) {
  const auto& request = setting.request;
  const bool fixed = !request.lambda.empty();
  const double smallest = kSmallest / setting.process.noise.tau;
  double lambda = fixed ? request.lambda[0] : 0.01 * request.accuracy / setting.process.noise.tau;
  Averaged averaged = average_at(setting, lambda);
  for (int n = 1; !fixed && n < kAttempts; ++n) {
    const double excess = averaged.largest_bias / (0.25 * request.accuracy);
    if (excess <= 1) break;
    const double smaller = std::max(lambda / (2 * excess), smallest);
    Averaged next = average_at(setting, smaller);
    // Where the bias no longer falls, rounding has taken over.
    if (next.largest_bias >= averaged.largest_bias) break;
    lambda = smaller;
    averaged = std::move(next);
  }
  Evaluation evaluation;
  append_averages(setting, averaged.values, evaluation.results);
  evaluation.checks = {{"lambda", lambda}, {"largest_relative_bias", averaged.largest_bias}};
  return evaluation;
}

}  // namespace stickslip::routes
