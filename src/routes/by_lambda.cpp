#include <algorithm>
#include <cmath>

#include "averages.hpp"
#include "routes.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/check.hpp"

namespace stickslip::routes {
namespace {

using operators::StaticPhase;
using operators::Symmetry;
using petsc::check;
using quantities::Uncertain;

constexpr int kMostTrials = 8, kMostMeans = 4;
// In units of 1/tau: where rounding does not rule yet in any case tried, and where it always does.
constexpr double kSafe = 1e-11, kSmallest = 1e-15;
constexpr int kMostSolves = 6;

/// What one lambda gives.
struct Trial {
  double lambda = 0;
  quantities::Results results;  // errors: rounding and bias
  double largest_bias = 0;      // relative
  double largest_error = 0;     // relative
};

/// R = (lambda - M)^-1 read at s+.
class FullGrid {
 public:
  FullGrid(const Problem& problem, double lambda)
      : lambda_(lambda),
        systems_(problem.comm, problem.discretisation, problem.statistics),
        system_(systems_.at(lambda, Symmetry::none, StaticPhase::kept)),
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

Trial average_at(const Problem& problem, double lambda) {
  FullGrid grid(problem, lambda);
  Trial trial;
  trial.lambda = lambda;
  std::vector<Uncertain> values;
  for (const auto& average : averages(problem)) {
    const auto mean = grid.of(average.f);
    values.push_back(mean.value);
    trial.largest_bias = std::max(trial.largest_bias, mean.bias / std::abs(mean.value.value));
  }
  append_averages(problem, values, trial.results);
  for (const auto& result : trial.results) {
    trial.largest_error = std::max(trial.largest_error, quantities::relative_error(result));
  }
  return trial;
}

/// The best lambda, by its whole error. The bias is proportional to lambda, while rounding grows
/// steeply as lambda falls: goes down by what the bias asks for, and where that was too far, by
/// geometric means between the best lambda and its neighbours.
class Search {
 public:
  explicit Search(const Problem& problem) : problem_(problem) {}

  Trial run() {
    const double tau = problem_.discretisation.process.noise.correlation_time(),
                 wanted = 0.25 * problem_.given.question.accuracy;
    best_ = average_at(problem_, std::max(0.01 * problem_.given.question.accuracy, kSafe) / tau);
    for (int n = 1, means = 0; n < kMostTrials && means < kMostMeans; ++n) {
      const double ratio = best_.largest_bias / wanted;
      if (ratio <= 1) break;
      if (smaller_ > 0) {
        try_lambda(std::sqrt(best_.lambda * (rounding_rules() ? larger_.lambda : smaller_)));
        ++means;
      } else {
        try_lambda(std::max(best_.lambda / (2 * ratio), kSmallest / tau));
      }
    }
    return std::move(best_);
  }

 private:
  // Whether the bias at the best lambda is not the one that larger lambdas let expect.
  [[nodiscard]] bool rounding_rules() const {
    if (larger_.lambda == 0) return false;
    return best_.largest_bias > 3 * larger_.largest_bias * best_.lambda / larger_.lambda;
  }

  void try_lambda(double lambda) {
    Trial trial = average_at(problem_, lambda);
    const bool better = trial.largest_error < best_.largest_error;
    if (better) std::swap(trial, best_);
    if (trial.lambda < best_.lambda) {
      smaller_ = trial.lambda;
    } else {
      larger_ = std::move(trial);
    }
  }

  const Problem& problem_;
  Trial best_, larger_;  // the next larger one tried, no lambda if there is none
  double smaller_ = 0;   // the next smaller one, 0 if there is none
};

}  // namespace

Evaluation by_lambda(const Problem& problem) {
  const auto& fixed = problem.given.question.lambda;
  Trial best = fixed.empty() ? Search(problem).run() : average_at(problem, fixed[0]);
  Evaluation evaluation;
  evaluation.results = std::move(best.results);
  evaluation.checks = {{"lambda", best.lambda, "averages are lambda u_lambda(s+) at this rate"},
                       {"largest_relative_bias", best.largest_bias,
                        "largest relative bias of an average from lambda > 0"}};
  return evaluation;
}

}  // namespace stickslip::routes
