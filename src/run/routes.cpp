#include "stickslip/run/routes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/linalg/eigensolver.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::run {
namespace {

using cases::Quantity;
using cases::Route;
using generator::KolmogorovOperator;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;
using quantities::Kind;
using quantities::scalar;
using quantities::Uncertain;

// Numbers of those that are not always results; those of the phases are there for others, too.
constexpr int kBeyond = 0, kStick = 1, kSlide = 2;

// Stationary averages pi(f) behind sticking, moments, noise_law and averages, for solution methods
// that compute pi(f) for one f after the other.
struct Average {
  quantities::Result result;  // blank
  model::Observable::Function f;
  int given = -1;  // number of the average that it is divided by, of a phase; -1: none
};

// Those that are asked for, after the probability of the levels on which a body always moves.
std::vector<Average> averages(const Problem& problem) {
  const cases::Question& question = problem.given.question;
  const auto& process = problem.discretisation.process;
  const auto named = [&](const char* f) {
    return model::parse_observable(f, process.friction).value;
  };
  std::vector<Average> all;
  const auto add = [&all](const quantities::Row& row, const model::Observable::Function& f) {
    all.push_back({quantities::blank(row), f});
  };
  const auto within = named("|x|<=mu_s"), stick = named("stick"), slide = named("slide");
  const double low = process.noise.level(process.lowest_static()),
               high = process.noise.level(process.highest_static());
  all.push_back({{}, [=](double x, double, double) { return x < low || x > high ? 1 : 0; }});
  if (question.wants(Quantity::sticking) || question.wants(Quantity::averages)) {
    add(cases::kPStick, stick);
    add(cases::kPSlide, slide);
  }
  if (question.wants(Quantity::moments)) {
    add(cases::kEV2, named("v^2"));
    add(cases::kEAbsV, named("|v|"));
    add(cases::kEXV, named("x*v"));
    if (process.drifts()) add(cases::kEV, named("v"));
  }
  if (question.wants(Quantity::noise_law)) {
    add(cases::kPWithin, within);
    add(cases::kEX2, named("x^2"));
  }
  if (!question.wants(Quantity::averages)) return all;
  for (const auto& observable : question.observables) {
    const auto f = observable.value;
    const auto append = [&](const quantities::Row& row, const model::Observable::Function& part,
                            int given) {
      all.push_back({quantities::blank(row, observable), part, given});
    };
    const auto within_phase = [f](const model::Observable::Function& in) {
      return [=](const model::Place& x, double y, double v) { return f(x, y, v) * in(x, y, v); };
    };
    append(cases::kPi, f, -1);
    append(cases::kPiStick, within_phase(stick), kStick);
    append(cases::kPiSlide, within_phase(slide), kSlide);
  }
  add(cases::kFrictionPower, model::friction_power(process.friction).value);
  return all;
}

// Everything from the sliding operator and the static chain, task by task.
Evaluation by_excursion(const Problem& problem) {
  Evaluation evaluation;
  generator::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  quantities::Computation computation{problem, systems, evaluation};
  const quantities::Plan plan = quantities::plan_of(problem.given);
  std::vector<std::optional<cases::Quantity>> owners;  // of the results
  const auto carry_out = [&](const quantities::Task& task) {
    const auto work = [&] { task.carry_out(computation); };
    if (task.quantity) quantities::attempt(problem, evaluation, *task.quantity, work);
    if (!task.quantity) work();
    owners.resize(evaluation.results.size(), task.quantity);
  };
  for (std::size_t n = 0; n < plan.tasks.size(); ++n) {
    carry_out(plan.tasks[n]);
    systems.keep(plan.used_from(n + 1));
  }
  for (const auto& task : plan.afterwards) carry_out(task);
  std::size_t at = 0;
  std::erase_if(evaluation.results, [&](const auto&) {
    const auto owner = owners[at++];
    return owner && evaluation.failed.contains(*owner);
  });
  for (auto& result : evaluation.results) {
    const bool complete = evaluation.missed.empty() || quantities::all_numbers(result);
    if (!complete) result.unreached = evaluation.missed;
  }
  return evaluation;
}

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

// R = (lambda - M)^-1 read at s+ of all averages.
Trial average_at(const Problem& problem, double lambda) {
  generator::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  auto& system = systems.at(lambda, Symmetry::none, StaticPhase::kept);
  const linalg::VecHandle at_exit = system.a().trace_at_exit();
  Trial trial;
  trial.lambda = lambda;
  std::vector<Uncertain> values;
  for (const auto& average : averages(problem)) {
    // c = R f/R 1 at s+ as the root of R(f - c) = 0, see by_lambda.
    const linalg::VecHandle rest = system.a().values(average.f);
    double c = 0, last = 0;
    linalg::Solution u;
    Uncertain step;
    for (int n = 0; n < kMostSolves; ++n) {
      check(VecShift(rest, -last));
      u = system.factors().solve(rest);
      step = lambda * quantities::value_of(at_exit, u);
      c += step.value;
      if (std::abs(step.value) <= 1e-15 * std::abs(c)) break;
      last = step.value;
    }
    const linalg::Solution twice = system.factors().solve(u.x);
    const double bias = std::abs(lambda * lambda * quantities::value_of(at_exit, twice).value);
    values.push_back({c, std::abs(step.value) + step.error + bias});
    trial.largest_bias = std::max(trial.largest_bias, bias / std::abs(c));
  }
  append_averages(problem, values, trial.results);
  for (const auto& result : trial.results) {
    trial.largest_error = std::max(trial.largest_error, quantities::relative_error(result));
  }
  return trial;
}

// The best lambda, by its whole error. The bias is proportional to lambda, while rounding grows
// steeply as lambda falls: goes down by what the bias asks for, and where that was too far, by
// geometric means between the best lambda and its neighbours.
Trial best_average(const Problem& problem) {
  const double tau = problem.discretisation.process.noise.correlation_time(),
               accuracy = problem.given.question.accuracy;
  Trial best = average_at(problem, std::max(0.01 * accuracy, kSafe) / tau);
  Trial larger;        // the next larger one tried, no lambda if there is none
  double smaller = 0;  // the next smaller one, 0 if there is none
  const auto try_lambda = [&](double lambda) {
    Trial trial = average_at(problem, lambda);
    if (trial.largest_error < best.largest_error) std::swap(trial, best);
    if (trial.lambda < best.lambda) {
      smaller = trial.lambda;
    } else {
      larger = std::move(trial);
    }
  };
  for (int n = 1, means = 0; n < kMostTrials && means < kMostMeans; ++n) {
    const double ratio = best.largest_bias / (0.25 * accuracy);
    if (ratio <= 1) break;
    if (smaller == 0) {
      try_lambda(std::max(best.lambda / (2 * ratio), kSmallest / tau));
      continue;
    }
    // Whether the bias at the best lambda is not the one that larger lambdas let expect.
    const bool rounding_rules =
        larger.lambda > 0 &&
        best.largest_bias > 3 * larger.largest_bias * best.lambda / larger.lambda;
    try_lambda(std::sqrt(best.lambda * (rounding_rules ? larger.lambda : smaller)));
    ++means;
  }
  return best;
}

// pi(f) = lambda u_lambda(s+; f) + O(lambda) with (lambda - M) u_lambda = f on the full grid; one
// factorisation for all f.
//
// With R = (lambda - M)^-1 a single solve loses rounding/lambda. Since lambda R 1 = 1, the number
// lambda R f at s+ also is the c for which R(f - c) = 0 there; found by c <- c + lambda R(f - c),
// whose solutions stay of order one, it keeps all digits for any lambda well above the rounding of
// the diagonal of M. The bias is measured: (lambda R)^2 f differs from pi(f) by O(lambda^2) only,
// so that lambda R f - (lambda R)^2 f is the bias up to O(lambda^2). Unless -lambda fixes it,
// lambda starts at accuracy/100 (of 1/tau) and is lowered until the bias is below a quarter of the
// accuracy, or as far as rounding lets the whole error fall.
Evaluation by_lambda(const Problem& problem) {
  const auto& fixed = problem.given.question.lambda;
  Trial best = fixed.empty() ? best_average(problem) : average_at(problem, fixed[0]);
  Evaluation evaluation;
  evaluation.results = std::move(best.results);
  evaluation.checks = {{"lambda", best.lambda, "averages are lambda u_lambda(s+) at this rate"},
                       {"largest_relative_bias", best.largest_bias,
                        "largest relative bias of an average from lambda > 0"}};
  return evaluation;
}

/// Means by the levels from which excursions start.
using Means = std::vector<Uncertain>;

/// Problems on the full grid up to the time at which `static_phase` kills.
class Hitting {
 public:
  Hitting(const Problem& problem, StaticPhase static_phase)
      : process_(problem.discretisation.process),
        starts_(process_.starts()),
        exit_rates_(process_.exit_rates()),
        systems_(problem.comm, problem.discretisation, problem.statistics),
        system_(systems_.at(0, Symmetry::none, static_phase)) {}

  /// Means of that time; where the process is killed at once it is 0.
  [[nodiscard]] Means time() {
    return solve(1, [this](std::size_t level) { return is_edge(level) ? 0.0 : 1.0; });
  }
  /// Means of what f is on the level, from the lowest one up, that kills at rest.
  [[nodiscard]] Means at_edge(const std::vector<double>& f) {
    const double rate = process_.noise.rate();
    return solve(0, [&](std::size_t level) { return is_edge(level) ? rate * f[level] : 0.0; });
  }

 private:
  [[nodiscard]] bool is_edge(std::size_t level) const { return exit_rates_[level] > 0; }

  // With a constant on sliding states, and `at_rest` by level.
  template <class AtRest>
  Means solve(double sliding, AtRest at_rest) {
    const auto& a = system_.a();
    const auto u = system_.factors().solve(a.by_state([&](const generator::State& state) {
      const bool rests = state.kind == generator::StateKind::static_phase;
      const int level = state.noise - process_.lowest_static();
      return rests ? at_rest(static_cast<std::size_t>(level)) : sliding;
    }));
    Means means;
    for (int start : starts_) means.push_back(quantities::value_of(a.trace_at_start(start), u));
    return means;
  }

  const model::Process& process_;
  std::vector<int> starts_;
  std::vector<double> exit_rates_;  // by static level
  generator::Systems systems_;
  generator::System& system_;
};

// P_slide = R^(s+)/(R-check(s+) + R(x_k)) of Prop. 4.1: mean times to rest, to the edge of rest,
// and from there to the exit, on the full grid and by the static chain, which alone decides from
// the edges on.
Evaluation by_hitting(const Problem& problem) {
  const auto& process = problem.discretisation.process;
  const auto chain = generator::StaticChain::of(process);
  const std::vector<double> ones(chain.size(), 1.0);
  const Means slides = Hitting(problem, StaticPhase::killing).time();
  Hitting edges(problem, StaticPhase::killing_edges);
  const Means to_edge = edges.time(), reached = edges.at_edge(ones);
  // All reach an edge: what rounding makes of that changes nothing else.
  const auto from_edge = [&](const std::vector<double>& f) {
    Means means = edges.at_edge(f);
    for (std::size_t t = 0; t < means.size(); ++t) means[t] = means[t] / reached[t];
    return means;
  };
  std::vector<Means> next(slides.size());
  for (int start : process.starts()) {
    const Means p = from_edge(chain.exit_transform_to(start));
    for (std::size_t t = 0; t < p.size(); ++t) next[t].push_back(p[t]);
  }
  const quantities::DiscountedStarts starts(0, Means(slides.size(), {1, 0}), next);
  const Uncertain slide = starts.mean(slides), reaching = starts.mean(to_edge),
                  leaving = starts.mean(from_edge(chain.integral(ones)));
  const Uncertain excursion = reaching + leaving, p_slide = slide / excursion;
  const double rounding = std::numeric_limits<double>::epsilon();
  const Uncertain p_stick{1 - p_slide.value, p_slide.error + rounding};
  Evaluation evaluation;
  evaluation.results = {scalar(cases::kPStick, p_stick), scalar(cases::kPSlide, p_slide),
                        scalar(cases::kMeanStick, excursion - slide),
                        scalar(cases::kMeanSlide, slide), scalar(cases::kMeanExcursion, excursion)};
  evaluation.checks = {
      {"R_hat", slide.value, "mean time from the onset of sliding to rest"},
      {"R_check", reaching.value,
       "mean time from the onset of sliding to rest on a level that the noise can leave"},
      {"R", leaving.value, "mean time from rest on such a level to the onset of sliding"}};
  return evaluation;
}

// Prefix of the PETSc options of this eigensolver.
constexpr const char* kNullPrefix = "null_";

// Smallest entry, 0 if none is negative; on an upwind grid pi is a probability.
double most_negative(Vec pi) {
  PetscReal smallest = 0;
  check(VecMin(pi, nullptr, &smallest));
  return std::min(smallest, 0.0);
}

// ||pi M||_1 / max row sum of |M|.
double relative_residual(Mat transposed, Vec pi) {
  linalg::VecHandle residual;
  check(VecDuplicate(pi, residual.out()));
  check(MatMult(transposed, pi, residual));
  PetscReal norm = 0;
  check(MatNorm(transposed, NORM_1, &norm));
  return linalg::norm(residual, NORM_1) / norm;
}

double integral(const KolmogorovOperator& a, Vec pi, const KolmogorovOperator::Observable& f) {
  return linalg::dot(a.values(f), pi);
}

// By renewal, excursions end at the rates at which pi leaves the static levels.
Uncertain mean_excursion(const Problem& problem, const KolmogorovOperator& a, Vec pi, Vec before) {
  const auto& process = problem.discretisation.process;
  const auto rates = process.exit_rates();
  const linalg::VecHandle exits = a.by_state([&](const generator::State& state) {
    const bool rests = state.kind == generator::StateKind::static_phase;
    return rests ? rates[state.noise - process.lowest_static()] : 0;
  });
  return quantities::changed_from(1 / linalg::dot(exits, before), 1 / linalg::dot(exits, pi));
}

void append_durations(Uncertain excursion, quantities::Results& results) {
  const auto share = [&](const quantities::Row& row) {
    const auto r = std::ranges::find(results, row.key, &quantities::Result::key);
    return Uncertain{r->value[0], r->error[0]};
  };
  const Uncertain stick = share(cases::kPStick) * excursion,
                  slide = share(cases::kPSlide) * excursion;
  results.push_back(scalar(cases::kMeanStick, stick));
  results.push_back(scalar(cases::kMeanSlide, slide));
  results.push_back(scalar(cases::kMeanExcursion, excursion));
}

// pi M = 0 by SLEPc on the full grid.
Evaluation by_null_vector(const Problem& problem) {
  const auto a = generator::assemble(problem.comm, problem.discretisation, 0, Symmetry::none,
                                     generator::StaticPhase::kept, problem.statistics);
  linalg::MatHandle transposed;  // of -M; its null vector is pi
  check(MatTranspose(a.matrix(), MAT_INITIAL_MATRIX, transposed.out()));
  // All eigenvalues of -M have real parts >= 0, and 0 is the one nearest to a small negative
  // target.
  const double target = -1e-6 / problem.discretisation.process.noise.correlation_time();
  linalg::Eigensolver solver(transposed, kNullPrefix, target, 1, problem.statistics);
  const Vec before = solver.pairs()[0].real;
  linalg::scale_to_sum_one(before);
  const linalg::VecHandle pi = linalg::copy_of(before);
  solver.iterate(pi);
  linalg::scale_to_sum_one(pi);

  Evaluation evaluation;
  std::vector<Uncertain> values;
  for (const auto& average : averages(problem)) {
    values.push_back(
        quantities::changed_from(integral(a, before, average.f), integral(a, pi, average.f)));
  }
  append_averages(problem, values, evaluation.results);
  const auto& question = problem.given.question;
  if (question.wants(Quantity::sticking) || question.wants(Quantity::averages)) {
    const Uncertain excursion = mean_excursion(problem, a, pi, before);
    if (question.wants(Quantity::sticking)) append_durations(excursion, evaluation.results);
    if (question.wants(Quantity::averages)) {
      evaluation.results.push_back(scalar(cases::kSlipRate, Uncertain{1, 0} / excursion));
    }
  }
  evaluation.checks = {{"norm_pi_M_over_norm_M", relative_residual(transposed, pi),
                        "residual of the null vector pi of the generator M"},
                       {"most_negative_pi", most_negative(pi), "smallest entry of pi"}};
  return evaluation;
}

// All methods that have a discretisation.
constexpr std::pair<Route, Evaluation (*)(const Problem&)> kComputations[] = {
    {Route::excursion, by_excursion},
    {Route::lambda, by_lambda},
    {Route::hitting, by_hitting},
    {Route::null_vector, by_null_vector},
    {Route::fluid_queue, by_fluid_queue}};

}  // namespace

void append_averages(const Problem& problem, const std::vector<Uncertain>& values,
                     quantities::Results& results) {
  const auto all = averages(problem);
  const cases::Question& question = problem.given.question;
  const auto& process = problem.discretisation.process;
  const double beyond =
      model::noise_moments(process.noise, process.lowest_static(), process.highest_static()).beyond;
  const double defect = std::abs(values[kBeyond].value / beyond - 1);
  for (int n = kBeyond + 1; n < static_cast<int>(all.size()); ++n) {
    Uncertain value = values[n];
    const bool phase = all[n].result.kind == Kind::share;
    if (phase && !question.wants(Quantity::sticking)) continue;
    if (all[n].given >= 0) value = value / values[all[n].given];
    double share = std::abs(value.value);
    if (phase && n == kStick) share = std::min(share, std::abs(values[kSlide].value));
    value.error += defect * share;
    results.push_back(scalar(all[n].result, value));
  }
  if (question.wants(Quantity::moments) && !process.drifts()) {
    results.push_back(quantities::scalar(cases::kEV, 0, 0));  // by symmetry
  }
}

Evaluation evaluate(const Problem& problem) {
  for (const auto& [route, evaluate_by] : kComputations) {
    if (route == problem.given.method.route) return evaluate_by(problem);
  }
  throw std::logic_error(
      fmt::format("-route {} works on no discretisation", problem.given.method.row().word));
}

linalg::Analysis analyse(const Problem& problem, const generator::SystemKey& key) {
  generator::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  return systems.analyse(key);
}

}  // namespace stickslip::run
