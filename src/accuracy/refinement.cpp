#include "stickslip/accuracy/refinement.hpp"

#include <fmt/format.h>
#include <petsctime.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "stickslip/accuracy/ladder.hpp"
#include "stickslip/petsc/memory.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::accuracy {
namespace {

using options::Quantity;
using quantities::Results;
using quantities::StationaryLaw;

double wall_time() {
  PetscLogDouble seconds = 0;
  (void)PetscTime(&seconds);
  return seconds;
}

std::string gigabytes(double bytes) { return fmt::format("{:.2g} GB", bytes / 1e9); }

// Quantities that need the sliding operator; values only, errors are set later.
Results evaluate(const options::Request& request, const model::Process& process,
                 const quantities::Excursion& excursion) {
  Results results;
  if (request.wants(Quantity::sticking)) quantities::append_sticking(excursion, results);
  if (request.wants(Quantity::moments)) quantities::append_moments(process, excursion, results);
  if (request.wants(Quantity::entry_law)) {
    quantities::append_entry_law(process, excursion, results);
  }
  return results;
}

double largest(const std::vector<double>& values) {
  double size = 0;
  for (double v : values) size = std::max(size, std::abs(v));
  return size;
}

// Largest error of a result relative to its size; arrays are measured by their largest entry.
double relative_error(const quantities::Result& result) {
  const double error = largest(result.error), size = largest(result.value);
  return error == 0 ? 0 : error / size;
}

class Refiner {
 public:
  Refiner(MPI_Comm comm, const options::Request& request, const Progress& progress)
      : comm_(comm), request_(request), progress_(progress), ladder_(request) {}

  Outcome run() {
    require_memory(ladder_.rung(1));
    for (int n = 0; n <= ladder_.last(); ++n) {
      if (n >= 2 && !fits(ladder_.rung(n))) return short_of_memory(n);
      solve(n);
      if (n >= 1 && finished()) return std::move(outcome_);
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
    return predicted_bytes(request_.scene, resolution) <= petsc::available_bytes(comm_);
  }

  void require_memory(const Resolution& resolution) const {
    const double need = predicted_bytes(request_.scene, resolution);
    const double have = petsc::available_bytes(comm_);
    if (need <= have) return;
    throw NoMemory(fmt::format(
        "about {:.3g} unknowns would need {} of memory, and {} are free; take a larger -delta, a "
        "looser -accuracy, fewer -noise_levels or more machines",
        static_cast<double>(unknowns(request_.scene, resolution)), gigabytes(need),
        gigabytes(have)));
  }

  void solve(int n) {
    Step step;
    step.resolution = ladder_.rung(n);
    if (progress_) progress_(n, step.resolution, expected_seconds(step.resolution));
    const double start = wall_time();
    const auto process = request_.scene.process(step.resolution.levels);
    auto law = solve_law(process, step);
    Results results = evaluate(request_, process, law->excursion());
    add_rounding(results, evaluate(request_, process, law->uncorrected()),
                 law->excursion().conservation_defect(process));
    if (n >= 1) add_discretisation(n, results);
    if (request_.wants(Quantity::density)) follow_speed_law(*law);
    step.seconds = wall_time() - start;
    outcome_.results = std::move(results);
    outcome_.law = std::move(law);
    outcome_.total += step.ledger;
    outcome_.steps.push_back(std::move(step));
  }

  [[nodiscard]] double expected_seconds(const Resolution& next) const {
    if (outcome_.steps.empty()) return 0;
    const Step& last = outcome_.steps.back();
    return last.seconds * relative_work(request_.scene, next) /
           relative_work(request_.scene, last.resolution);
  }

  // One set of factors at a time.
  std::unique_ptr<StationaryLaw> solve_law(const model::Process& process, Step& step) {
    operators::Systems systems(comm_, process, make_axis(request_.scene, step.resolution),
                               step.ledger);
    auto law = std::make_unique<StationaryLaw>(systems);
    if (request_.wants(Quantity::entry_law)) {
      systems.release(0, operators::Symmetry::even);
      law->orient(systems);
    }
    return law;
  }

  // Sets errors to the rounding estimate, and keeps it apart for the verdict.
  void add_rounding(Results& results, const Results& uncorrected, double defect) {
    rounding_.clear();
    for (std::size_t r = 0; r < results.size(); ++r) {
      auto& result = results[r];
      for (std::size_t e = 0; e < result.value.size(); ++e) {
        const double value = result.value[e];
        result.error[e] = std::abs(value - uncorrected[r].value[e]) + defect * std::abs(value);
      }
      rounding_.push_back(relative_error(result));
    }
  }

  void add_discretisation(int n, Results& results) {
    const double factor = ladder_.error_per_change(n);
    std::vector<std::vector<double>> changes;
    for (std::size_t r = 0; r < results.size(); ++r) {
      auto& result = results[r];
      changes.emplace_back();
      for (std::size_t e = 0; e < result.value.size(); ++e) {
        const double change = std::abs(result.value[e] - outcome_.results[r].value[e]);
        double error = factor * change;
        if (n >= 2) error = std::max(error, ladder_.error_per_earlier_change() * changes_[r][e]);
        result.error[e] += error;
        changes.back().push_back(change);
      }
    }
    changes_ = std::move(changes);
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
    for (std::size_t r = 0; r < outcome_.results.size(); ++r) {
      const double error = relative_error(outcome_.results[r]);
      if (error <= step.estimate) continue;
      step.estimate = error;
      step.limiting_key = outcome_.results[r].key;
      rounding = rounding_[r];
    }
    outcome_.reached = step.estimate <= request_.accuracy;
    if (outcome_.reached) {
      check_cut();
      return true;
    }
    if (rounding <= request_.accuracy) return false;
    outcome_.shortfall = fmt::format("rounding limits {} to {:.1e}; take -accuracy {:.0e}",
                                     step.limiting_key, rounding, 2 * rounding);
    return true;
  }

  // A velocity cut made by hand is no part of the model: what it holds back is an error.
  void check_cut() {
    if (!request_.scene.v_max) return;
    const auto law = outcome_.law->speed_law();
    const double held = law.at_top, sliding = 1 - law.at_rest;
    if (held <= request_.accuracy * sliding) return;
    outcome_.reached = false;
    outcome_.shortfall = fmt::format(
        "-v_max = {:g} holds back {:.1e} of the sliding time; leave it out, or take it larger",
        *request_.scene.v_max, held / sliding);
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
  std::vector<double> rounding_;              // relative, of each result
  std::vector<std::vector<double>> changes_;  // of the last step, by result and entry
  std::shared_ptr<const velocity::Axis> coarse_axis_;
  StationaryLaw::SpeedLaw coarse_law_;
};

bool needs_system(const options::Request& request) {
  return std::any_of(request.quantities.begin(), request.quantities.end(),
                     [](Quantity q) { return q != Quantity::noise_law; });
}

}  // namespace

Outcome refine(MPI_Comm comm, const options::Request& request, const Progress& progress) {
  Outcome outcome;
  outcome.reached = true;
  if (needs_system(request)) outcome = Refiner(comm, request, progress).run();
  if (request.wants(Quantity::noise_law)) {
    quantities::append_noise_law(request.scene.meant(), outcome.results);
  }
  return outcome;
}

}  // namespace stickslip::accuracy
