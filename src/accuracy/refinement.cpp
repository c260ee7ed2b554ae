#include "stickslip/accuracy/refinement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "stickslip/accuracy/ladder.hpp"
#include "stickslip/accuracy/laws.hpp"
#include "stickslip/operators/laws.hpp"
#include "stickslip/petsc/memory.hpp"
#include "stickslip/quantities/sensitivity.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::accuracy {
namespace {

using options::Quantity;
using quantities::Result;
using quantities::Results;
using quantities::StationaryLaw;

// Sums of positive terms over levels are rounded even where nothing else is wrong, as for a mean
// stay that has the same entry law on every discretisation.
void add_rounding_of_sums(const model::NoiseChain& noise, Results& results) {
  const double rounding = model::rounding_of_sums(noise);
  for (auto& result : results) {
    for (std::size_t e = 0; e < result.value.size(); ++e) {
      result.error[e] = std::max(result.error[e], rounding * std::abs(result.value[e]));
    }
  }
}

// A change from grid to grid that passes through zero hides an error, which the other means under
// the same law show: their relative errors are alike within a decade or two. Of 144 scenes with six
// drags at accuracy 1e-4, 27 had a mean with more error than estimate (up to 1700 times) before.
constexpr double kShareOfLargest = 0.05;
// A mean that changes less does not depend on the grid, as the stay at a single static level.
constexpr double kUnchanged = 1e-13;

void share_errors(Results& results) {
  const auto is_mean = [](const Result& r) {
    return r.is_scalar() && (r.key.starts_with("mean_") || r.key.starts_with("E_"));
  };
  double largest = 0, odds = 1;  // P_stick P_slide
  for (const auto& r : results) {
    // The drift may vanish.
    if (is_mean(r) && r.key != "E_V") largest = std::max(largest, quantities::relative_error(r));
    if (r.key == "P_stick" || r.key == "P_slide") odds *= r.value[0];
  }
  const double shared = kShareOfLargest * largest;
  for (auto& r : results) {
    if (!r.is_scalar()) continue;
    double& error = r.error[0];
    const double size = std::abs(r.value[0]);
    const bool dependent = error > kUnchanged * size;
    if (is_mean(r) && dependent) error = std::max(error, shared * size);
    // P_slide / P_stick is the ratio of two means.
    const bool probability = r.key == "P_stick" || r.key == "P_slide";
    if (probability && dependent) error = std::max(error, shared * odds);
  }
}

std::string gigabytes(double bytes) { return fmt::format("{:.2g} GB", bytes / 1e9); }

/// A step, which `evaluate` makes of its setting.
template <class Evaluate>
Solved stepped(MPI_Comm comm, const options::Request& request, const Resolution& resolution,
               Evaluate evaluate) {
  Solved solved;
  Step& step = solved.step;
  step.resolution = resolution;
  const double start = petsc::wall_seconds();
  const routes::Setting setting{comm, request, request.scene.process(resolution.levels),
                                make_axis(request.scene, resolution), step.ledger};
  solved.evaluation = evaluate(setting);
  add_rounding_of_sums(setting.process.noise, solved.evaluation.results);
  step.checks = std::move(solved.evaluation.checks);
  step.seconds = petsc::wall_seconds() - start;
  return solved;
}

Solved evaluated(MPI_Comm comm, const options::Request& request, const Resolution& resolution) {
  return stepped(comm, request, resolution, routes::evaluate);
}

// Beyond the levels and the axis of the first discretisation there is nothing but extrapolation.
void require_start_within(const options::Request& request, const Resolution& first) {
  if (!request.wants(Quantity::expectation)) return;
  const double delta = request.scene.delta, x = request.start_level * delta, v = request.start_v;
  const auto refuse = [&](const char* what, double largest, const char* more) {
    throw BadInput(fmt::format("-start = {:g},{:g}: starts beyond the largest {} on which the mean "
                               "is computed at -accuracy {:g}; take |{}| at most {:g}, or {}",
                               x, v, what, request.accuracy, what, largest, more));
  };
  if (std::abs(request.start_level) > first.levels) {
    refuse("x", first.levels * delta, "-noise_levels full");
  }
  if (std::abs(v) > first.v_max) {
    refuse("v", first.v_max, "-quantities trajectory, which starts anywhere");
  }
}

/// A discretisation whose factors serve the next ones.
struct Base {
  Base(const Resolution& resolution, const routes::Setting& s)
      : of(resolution), evaluation({s.comm, s.request, s.process, s.axis, ledger}) {}
  Resolution of;
  petsc::Ledger ledger;  // of the factors, which go on counting
  routes::NestedEvaluation evaluation;
};

// Of the tolerance of noise range and velocity cut: what they hide was at most 2.3 times it without
// drag, and a tenth of it with drag, in scenes for which they were widened alone.
constexpr double kErrorPerTolerance = 5;

class Refiner {
 public:
  Refiner(MPI_Comm comm, const options::Request& request, const Progress& progress)
      : comm_(comm), request_(request), progress_(progress), ladder_(request) {}

  Outcome run() {
    require_start_within(request_, ladder_.rung(0));
    require_memory(comm_, request_, ladder_.rung(1));
    for (int n = 0; n <= ladder_.last(); ++n) {
      if (n >= 2 && !fits(ladder_.rung(n))) return short_of_memory(n);
      solve(n);
      if (n >= 1 && finished()) {
        if (outcome_.reached) outcome_.next_digit_seconds = next_digit(n);
        return std::move(outcome_);
      }
      if (n >= 1 && ladder_.first_order() && hopeless(n)) return std::move(outcome_);
    }
    outcome_.shortfall = request_.method.fixed()
                             ? "the discretisation is fixed by hand; leave -degree, -layers and -p "
                               "out to have it refined"
                             : "no finer discretisation is tried";
    return std::move(outcome_);
  }

 private:
  [[nodiscard]] bool fits(const Resolution& resolution) const {
    double need = predicted_bytes(request_.scene, resolution);
    if (base_ && resolution.shares_factors()) need -= predicted_bytes(request_.scene, base_->of);
    return need <= petsc::available_bytes(comm_, need);
  }

  void solve(int n) {
    const Resolution resolution = ladder_.rung(n);
    if (progress_) progress_(n, resolution, expected_seconds(resolution));
    auto [evaluation, step] = solved_on(n, resolution);
    if (step.resolution.nested) {
      add_truncation(n, evaluation.results);
    } else {
      remember_rounding(evaluation.results);
    }
    if (n >= 1) add_discretisation(n, evaluation.results);
    if (request_.wants(Quantity::density)) follow_speed_law(*evaluation.law);
    outcome_.last = std::move(evaluation);
    outcome_.total += step.ledger;
    outcome_.steps.push_back(std::move(step));
  }

  [[nodiscard]] Solved solved_on(int n, Resolution resolution) {
    if (resolution.nested && base_) {
      try {
        return stepped(comm_, request_, resolution, [this](const routes::Setting& setting) {
          return base_->evaluation.finer(setting);
        });
      } catch (const NotReached&) {
        // By itself, then.
      }
    }
    resolution.nested = false;
    base_.reset();
    if (n == ladder_.last() || !ladder_.rung(n + 1).nested) {
      return evaluated(comm_, request_, resolution);
    }
    return stepped(comm_, request_, resolution, [&](const routes::Setting& setting) {
      base_ = std::make_unique<Base>(resolution, setting);
      setting.ledger += base_->ledger;
      return base_->evaluation.coarse();
    });
  }

  [[nodiscard]] double expected_seconds(const Resolution& next) const {
    if (outcome_.steps.empty()) return 0;
    const Step& last = outcome_.steps.back();
    return last.seconds * relative_work(request_.scene, next) /
           relative_work(request_.scene, last.resolution);
  }

  // The errors of the route itself, for the verdict.
  void remember_rounding(const Results& results) {
    rounding_.clear();
    for (const auto& result : results) rounding_.push_back(quantities::relative_error(result));
  }

  // Nested rungs are cut where the one before is, so that no change shows it.
  void add_truncation(int n, Results& results) const {
    const double relative = kErrorPerTolerance * ladder_.tail_tolerance(n);
    for (auto& result : results) {
      for (std::size_t e = 0; e < result.value.size(); ++e) {
        result.error[e] += relative * std::abs(result.value[e]);
      }
    }
  }

  void add_discretisation(int n, Results& results) {
    const double factor = ladder_.error_per_change(n);
    std::vector<std::vector<double>> changes(results.size());
    for (std::size_t r = 0; r < results.size(); ++r) {
      auto& result = results[r];
      const auto& coarse = outcome_.last.results[r].value;
      for (std::size_t e = 0; e < result.value.size(); ++e) {
        // A mode that the coarser grid did not find is all change.
        const double before = e < coarse.size() ? coarse[e] : 0;
        const double change = std::abs(result.value[e] - before);
        double error = factor * change;
        if (n >= 2 && e < changes_[r].size()) {
          error = std::max(error, ladder_.error_per_earlier_change() * changes_[r][e]);
        }
        result.error[e] += error;
        changes[r].push_back(change);
      }
    }
    changes_ = std::move(changes);
    share_errors(results);
  }

  // The density's own measure: how far the distribution function of |V| moved. It converges
  // slowly (the density has corners), so the whole change is taken for the error.
  void follow_speed_law(const StationaryLaw& law) {
    auto now = law.speed_law();
    if (coarse_axis_) {
      outcome_.speed_law_error =
          quantities::speed_law_distance(*coarse_axis_, coarse_law_, law.axis(), now);
    }
    coarse_law_ = std::move(now);
    coarse_axis_ = law.shared_axis();
  }

  [[nodiscard]] bool finished() {
    Step& step = outcome_.steps.back();
    double rounding = 0;
    for (std::size_t r = 0; r < outcome_.last.results.size(); ++r) {
      const double error = quantities::relative_error(outcome_.last.results[r]);
      if (error <= step.estimate) continue;
      step.estimate = error;
      step.limiting_key = outcome_.last.results[r].key;
      rounding = rounding_[r];
    }
    outcome_.reached = step.estimate <= request_.accuracy;
    if (outcome_.reached) {
      check_cut();
      check_laws();
      return true;
    }
    // What a finer discretisation still improves is no limit yet.
    const bool falls = rounding < 0.5 * std::exchange(last_rounding_, rounding);
    if (rounding <= request_.accuracy || falls) return false;
    const bool by_lambda = request_.route == options::Route::lambda;
    const double least = std::max(rounding, step.estimate);
    const std::string looser = least < 0.05
                                   ? fmt::format("take {}-accuracy {:.0e}",
                                                 by_lambda ? "another -lambda or " : "", 2 * least)
                                   : "no digit of it is left: leave it out";
    outcome_.shortfall = fmt::format(
        "{} {} to {:.1e}; {}", by_lambda ? "lambda > 0 or rounding limits" : "rounding limits",
        step.limiting_key, least, looser);
    return true;
  }

  // Time of the run that would find one digit more, from how fast estimates fell.
  [[nodiscard]] double next_digit(int n) const {
    const auto& steps = outcome_.steps;
    double fall = 1;  // digits a step
    if (steps.size() >= 3 && steps.back().estimate > 0) {
      fall = std::log10(steps[steps.size() - 2].estimate / steps.back().estimate);
    }
    if (ladder_.first_order()) fall = std::log10(2.0);
    const int more = static_cast<int>(std::ceil(1 / std::clamp(fall, 0.2, 10.0)));
    if (n + more > ladder_.last() || 0.1 * request_.accuracy < 1e-14) return 0;
    double seconds = 0;
    for (const Step& step : steps) seconds += step.seconds;
    const auto work = [this](int rung) {
      Resolution alone = ladder_.rung(rung);
      alone.nested = false;
      return relative_work(request_.scene, alone);
    };
    return seconds * work(n + more) / work(n);
  }

  // A velocity cut made by hand is no part of the model: what it holds back is an error.
  void check_cut() {
    if (!request_.scene.v_max) return;
    const auto law = outcome_.last.law->speed_law();
    const double held = law.at_top, sliding = 1 - law.at_rest;
    if (held <= request_.accuracy * sliding) return;
    outcome_.reached = false;
    outcome_.shortfall = fmt::format(
        "-v_max = {:g} holds back {:.1e} of the sliding time; leave it out, or take it larger",
        *request_.scene.v_max, held / sliding);
  }

  // Errors that are too small betray themselves where results break a law.
  void check_laws() {
    const std::string broken = broken_law(outcome_.last.results);
    if (broken.empty()) return;
    const int levels = outcome_.steps.back().resolution.levels;
    outcome_.reached = false;
    outcome_.shortfall = broken + operators::please_report(request_.scene.process(levels));
  }

  // A first-order scheme tells early how many points it would take.
  [[nodiscard]] bool hopeless(int n) {
    const Resolution now = ladder_.rung(n);
    const double needed = now.points * outcome_.steps.back().estimate / request_.accuracy;
    if (n < 3 || request_.method.fixed()) return false;
    Resolution final = now;
    final.points = static_cast<int>(std::min(needed, 1e9));
    if (fits(final)) return false;
    outcome_.shortfall = fmt::format(
        "the upwind scheme would need about p = {:.1e} and {} of memory; take -scheme hp, or "
        "-accuracy {:.0e}",
        needed, gigabytes(predicted_bytes(request_.scene, final)),
        2 * outcome_.steps.back().estimate);
    return true;
  }

  Outcome short_of_memory(int n) {
    outcome_.shortfall = fmt::format("the next refinement would need {} of memory",
                                     gigabytes(predicted_bytes(request_.scene, ladder_.rung(n))));
    return std::move(outcome_);
  }

  MPI_Comm comm_;
  const options::Request& request_;
  const Progress& progress_;
  Ladder ladder_;
  Outcome outcome_;
  std::unique_ptr<Base> base_;    // of the next rungs that are nested
  std::vector<double> rounding_;  // relative, of each result
  double last_rounding_ = std::numeric_limits<double>::infinity();  // of the limiting result
  std::vector<std::vector<double>> changes_;  // of the last step, by result and entry
  std::shared_ptr<const velocity::Axis> coarse_axis_;
  StationaryLaw::SpeedLaw coarse_law_;
};

// The law of the noise has a closed form; routes that check the model compute it all the same.
bool closed_noise_law(const options::Request& request) {
  return request.wants(Quantity::noise_law) && request.route == options::Route::excursion;
}

Outcome simulate(MPI_Comm comm, const options::Request& request,
                 const routes::SimulationProgress& progress) {
  Outcome outcome;
  auto simulated = routes::monte_carlo(comm, request, progress);
  outcome.last.results = std::move(simulated.results);
  outcome.reached = simulated.reached;
  outcome.shortfall = simulated.shortfall;
  outcome.next_digit_seconds = 100 * simulated.state.seconds;
  outcome.simulation = std::move(simulated);
  return outcome;
}

}  // namespace

void require_memory(MPI_Comm comm, const options::Request& request, const Resolution& resolution) {
  const double need = predicted_bytes(request.scene, resolution);
  const double have = petsc::available_bytes(comm, need);
  if (need <= have) return;
  throw NoMemory(fmt::format(
      "about {:.3g} unknowns would need {} of memory, and {} are free; take a larger -delta, a "
      "looser -accuracy, fewer -noise_levels or more machines",
      static_cast<double>(unknowns(request.scene, resolution)), gigabytes(need), gigabytes(have)));
}

bool needs_system(const options::Request& request) {
  std::size_t others = request.quantities.size();
  for (bool closed : {closed_noise_law(request), request.wants(Quantity::trajectory),
                      request.wants(Quantity::sensitivity)}) {
    others -= closed ? 1 : 0;
  }
  return others > 0;
}

Solved solve_on(MPI_Comm comm, const options::Request& request, const Resolution& resolution) {
  require_memory(comm, request, resolution);
  return evaluated(comm, request, resolution);
}

Outcome refine(MPI_Comm comm, const options::Request& request, const Progress& progress,
               const routes::SimulationProgress& simulation_progress) {
  Outcome outcome;
  outcome.reached = true;
  if (needs_system(request)) {
    outcome = request.route == options::Route::monte_carlo
                  ? simulate(comm, request, simulation_progress)
                  : Refiner(comm, request, progress).run();
  }
  if (closed_noise_law(request)) {
    quantities::append_noise_law(request.scene.meant(), outcome.last.results);
    if (request.wants(Quantity::sensitivity)) {
      quantities::append_noise_sensitivity(request.scene.meant(), outcome.last.results);
    }
  }
  if (request.wants(Quantity::trajectory)) {
    outcome.path = simulation::simulate_path(request.scene.meant(), request.start_level,
                                             request.start_v, request.horizon, request.seed);
  }
  if (!request.references.empty()) {
    outcome.comparison = compare(request.compared, request.references, outcome.last.results);
  }
  return outcome;
}

}  // namespace stickslip::accuracy
