#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "routes.hpp"
#include "stickslip/catalogue/autocorrelation_keys.hpp"
#include "stickslip/catalogue/duration_density_keys.hpp"
#include "stickslip/catalogue/expectation_keys.hpp"
#include "stickslip/effects/effect.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/displacement.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/first_passage.hpp"
#include "stickslip/quantities/laplace.hpp"
#include "stickslip/quantities/resolvent.hpp"
#include "stickslip/quantities/sensitivity.hpp"
#include "stickslip/quantities/slip.hpp"
#include "stickslip/quantities/spectrum.hpp"
#include "stickslip/quantities/state_averages.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/transient.hpp"
#include "stickslip/routes/plan.hpp"

namespace stickslip::routes {
namespace {

using cases::Case;
using cases::Question;
using catalogue::Quantity;
using operators::Symmetry;
using quantities::Results;
using quantities::StationaryDistribution;
using quantities::Uncertain;

// Appends what `append` makes of the excursion, with rounding for error: the effect of iterative
// refinement, and the defect of an exact identity.
template <class Append>
void append_with_rounding(const StationaryDistribution& distribution, Results& results,
                          Append append) {
  Results corrected, uncorrected;
  append(distribution.excursion(), corrected);
  append(distribution.uncorrected(), uncorrected);
  const double defect = distribution.excursion().conservation_defect(distribution.discretisation());
  for (std::size_t r = 0; r < corrected.size(); ++r) {
    auto& result = corrected[r];
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      const double value = result.value[n];
      result.error[n] += std::abs(value - uncorrected[r].value[n]) + defect * std::abs(value);
    }
    results.push_back(std::move(result));
  }
}

void append_distribution(const Question& question, const StationaryDistribution& distribution,
                         Results& results) {
  append_with_rounding(distribution, results, [&](const auto& excursion, Results& found) {
    if (question.wants(Quantity::sticking)) quantities::append_sticking(excursion, found);
    if (question.wants(Quantity::slip)) quantities::append_mean_slip(excursion, found);
    if (!question.wants(Quantity::moments)) return;
    quantities::append_moments(distribution.discretisation(), excursion, found);
  });
}

std::vector<Uncertain> entry_law(const StationaryDistribution& distribution) {
  const auto& p = distribution.excursion().entry;
  const auto& before = distribution.uncorrected().entry;
  std::vector<Uncertain> entry;
  for (std::size_t n = 0; n < p.size(); ++n) entry.push_back({p[n], std::abs(p[n] - before[n])});
  return entry;
}

// A tenth of the accuracy, so that reduced models do not rule the error.
quantities::ModelTolerance tolerance_of(const Problem& problem) {
  return {0.1 * problem.given.question.accuracy, problem.recipes};
}

// Puts values at the frequencies of waves, each found on elements of its own, between the others.
void put_waves(const Problem& problem, quantities::Spectrum& spectrum) {
  const auto smooth = std::exchange(spectrum.value, {});
  auto next = smooth.begin();
  for (double omega : problem.given.question.omega) {
    const auto wave = problem.waves.find(omega);
    if (wave == problem.waves.end()) {
      spectrum.value.push_back(*next++);
      continue;
    }
    operators::Systems systems(problem.comm, wave->second, problem.statistics);
    const StationaryDistribution distribution(systems);
    systems.release({0, operators::symmetry_of(systems.process())});
    spectrum.value.push_back(quantities::direct_spectrum(systems, distribution, {omega}).front());
  }
}

void append_spectrum(operators::Systems& systems, const Problem& problem, Evaluation& evaluation) {
  const auto& omega = problem.given.question.omega;
  const auto& distribution = *evaluation.distribution;
  std::vector<double> smooth;
  std::copy_if(omega.begin(), omega.end(), std::back_inserter(smooth),
               [&](double w) { return !problem.waves.contains(w); });
  const bool direct = problem.given.method.spectrum_solver == cases::SpectrumSolver::direct;
  quantities::ReducedSpectrum reduced;
  auto& spectrum = reduced.spectrum;
  if (direct) {
    smooth.push_back(0);
    spectrum.value = quantities::direct_spectrum(systems, distribution, smooth);
    spectrum.at_zero = spectrum.value.back();
    spectrum.value.pop_back();
  } else {
    reduced = quantities::reduced_spectrum(systems, distribution, smooth, tolerance_of(problem));
  }
  put_waves(problem, spectrum);
  quantities::append_spectrum(omega, spectrum, evaluation.results);
  if (direct) return;
  quantities::append_shape(reduced.shape, evaluation.results);
  evaluation.checks.emplace_back("krylov_pairs", reduced.pairs);
  evaluation.checks.emplace_back("krylov_shifts", static_cast<double>(reduced.shifts.size()));
}

void append_durations(operators::Systems& systems, const Problem& problem, Evaluation& evaluation) {
  const auto& time = problem.given.question.time;
  const auto& distribution = *evaluation.distribution;
  const auto tolerance = tolerance_of(problem);
  const auto slide = quantities::slide_distribution(systems, distribution, time, tolerance);
  const auto stick =
      quantities::stick_distribution(problem.discretisation.process, entry_law(distribution), time);
  const auto excursion = quantities::excursion_distribution(systems, distribution, time, tolerance);
  quantities::append_distribution(catalogue::kDensitySlide, catalogue::kCdfSlide, time, slide,
                                  evaluation.results);
  quantities::append_distribution(catalogue::kDensityStick, catalogue::kCdfStick, time, stick,
                                  evaluation.results);
  quantities::append_distribution(catalogue::kDensityExcursion, catalogue::kCdfExcursion, time,
                                  excursion, evaluation.results);
  evaluation.checks.emplace_back("slide_pairs", slide.pairs);
  evaluation.checks.emplace_back("excursion_pairs", excursion.pairs);
}

quantities::TransientMethod transient_method(const cases::Method& method) {
  return method.transient_solver == cases::TransientSolver::krylov
             ? quantities::TransientMethod::krylov
             : quantities::TransientMethod::stepping;
}

void append_function_of_time(quantities::Result result, const std::vector<Uncertain>& values,
                             Results& results) {
  for (const auto& value : values) quantities::append_value(result, value);
  results.push_back(std::move(result));
}

void append_autocorrelation(operators::Systems& systems, const Problem& problem,
                            Evaluation& evaluation) {
  const Question& question = problem.given.question;
  const auto method = transient_method(problem.given.method);
  const auto values = quantities::autocorrelation(systems, *evaluation.distribution, question.time,
                                                  method, tolerance_of(problem));
  append_function_of_time(quantities::array(catalogue::kAutocovariance, question.time), values,
                          evaluation.results);
}

void append_expectations(operators::Systems& systems, const Problem& problem,
                         Evaluation& evaluation) {
  const Question& question = problem.given.question;
  const auto method = transient_method(problem.given.method);
  for (const auto& f : question.observables) {
    const auto expectation =
        quantities::expectation(systems, *evaluation.distribution, f, question.start, question.time,
                                method, tolerance_of(problem));
    append_function_of_time(
        quantities::array(quantities::blank(catalogue::kExpectationOf, f), question.time),
        expectation.value, evaluation.results);
    evaluation.results.push_back(quantities::scalar(quantities::blank(catalogue::kStationaryOf, f),
                                                    expectation.stationary, expectation.unseen));
  }
}

/// Carries out the tasks of a plan on one discretisation.
class Execution {
 public:
  explicit Execution(const Problem& problem)
      : problem_(problem),
        given_(problem.given),
        question_(given_.question),
        systems_(problem.comm, problem.discretisation, problem.statistics) {}

  Evaluation run() {
    const Plan plan = plan_of(given_);
    for (std::size_t n = 0; n < plan.tasks.size(); ++n) {
      carry_out(plan.tasks[n]);
      systems_.keep(plan.used_from(n + 1));
    }
    append_arrays();
    return std::move(evaluation_);
  }

 private:
  void carry_out(const Task& task) {
    switch (task.work) {
    case Work::stationary_distribution: return find_distribution();
    case Work::averages: return find_averages();
    case Work::orientation: return find_hitting_distribution();
    case Work::sensitivity: return find_sensitivity();
    case Work::duration_moments: return find_duration_moments();
    case Work::duration_transforms: return transform_durations(question_.lambda[task.at]);
    case Work::stick_duration_transforms: return transform_stick_durations();
    case Work::resolvent:
      resolvents_.push_back(
          quantities::resolvent(systems_, question_.lambda[task.at], question_.observables));
      return;
    case Work::spectrum: return append_spectrum(systems_, problem_, evaluation_);
    case Work::durations: return append_durations(systems_, problem_, evaluation_);
    case Work::slips:
      return quantities::append_slip_moments(
          process(), quantities::slip_moments(systems_, distribution()), results());
    case Work::slip_transform: return transform_slips(question_.inverse_distance[task.at]);
    case Work::slip_distribution: return find_slip_distribution();
    case Work::first_passage: return pass(question_.velocity[task.at]);
    case Work::displacement: return find_displacement();
    case Work::autocorrelation: return append_autocorrelation(systems_, problem_, evaluation_);
    case Work::expectation: return append_expectations(systems_, problem_, evaluation_);
    case Work::relaxation: return find_modes();
    }
  }

  [[nodiscard]] const StationaryDistribution& distribution() const {
    return *evaluation_.distribution;
  }
  [[nodiscard]] Results& results() { return evaluation_.results; }
  [[nodiscard]] const model::Process& process() const { return problem_.discretisation.process; }

  void find_distribution() {
    evaluation_.distribution = std::make_shared<StationaryDistribution>(systems_);
    append_distribution(question_, distribution(), results());
  }

  void find_averages() {
    const Symmetry symmetry = operators::symmetry_of(problem_.discretisation.process);
    quantities::append_averages(distribution(), systems_.at(0, symmetry).a(), question_.observables,
                                results());
  }

  void find_hitting_distribution() {
    evaluation_.distribution->orient(systems_);
    append_with_rounding(distribution(), results(), [this](const auto& excursion, Results& found) {
      quantities::append_hitting_distribution(problem_.discretisation.process, excursion, found);
    });
  }

  void find_sensitivity() {
    const quantities::Sensitivity sensitivity(systems_, distribution(),
                                              effects::derivatives_of(given_.scene));
    if (question_.wants(Quantity::sticking)) sensitivity.append_sticking(results());
    if (question_.wants(Quantity::moments)) sensitivity.append_moments(results());
  }

  void find_duration_moments() {
    const auto entry = entry_law(distribution());
    const auto moments = quantities::duration_moments(systems_, distribution(), entry);
    quantities::append_duration_moments(problem_.discretisation.process, distribution().sides(),
                                        moments, entry, results());
  }

  void transform_durations(double lambda) {
    const auto t = quantities::sliding_transforms(systems_, distribution(), lambda);
    const auto stick = quantities::stick_transform(problem_.discretisation.process, lambda,
                                                   entry_law(distribution()));
    transforms_.push_back({t.slide, stick, t.excursion});
  }

  void transform_slips(double s) {
    slip_transforms_.push_back(quantities::slip_transform(systems_, distribution(), s));
  }

  void find_slip_distribution() {
    const auto& distance = question_.distance;
    const auto slips =
        quantities::slip_distribution(systems_, distribution(), distance, tolerance_of(problem_));
    quantities::append_slip(distance, slips, results());
    evaluation_.checks.emplace_back("slip_pairs", slips.pairs);
  }

  void pass(double speed) {
    const auto& found = evaluation_.distribution;
    passages_.push_back(quantities::first_passage(
        systems_, found ? found->sides() : quantities::SideChain{}, speed));
  }

  void find_displacement() {
    const auto x = quantities::displacement(systems_, distribution(), question_.start,
                                            question_.time, tolerance_of(problem_));
    quantities::append_displacement(question_.time, x, results());
  }

  void transform_stick_durations() {
    quantities::append_stick_transform(problem_.discretisation.process, question_.lambda,
                                       entry_law(distribution()), results());
  }

  void find_modes() {
    for (Symmetry symmetry : operators::sectors_of(problem_.discretisation.process)) {
      evaluation_.modes.push_back(quantities::relaxation_modes(systems_, symmetry));
      quantities::append_relaxation(evaluation_.modes.back(), results());
    }
  }

  // What was found one value at a time.
  void append_arrays() {
    const auto& lambda = question_.lambda;
    if (!transforms_.empty()) quantities::append_laplace(lambda, transforms_, results());
    if (!slip_transforms_.empty()) {
      quantities::append_slip_transform(question_.inverse_distance, slip_transforms_, results());
    }
    if (!passages_.empty()) {
      quantities::append_first_passages(question_.velocity, passages_, results());
    }
    if (resolvents_.empty()) return;
    quantities::append_resolvent(lambda, question_.observables, resolvents_,
                                 !problem_.discretisation.process.drifts(), results());
  }

  const Problem& problem_;
  const Case& given_;
  const Question& question_;
  operators::Systems systems_;
  Evaluation evaluation_;
  std::vector<quantities::DurationTransforms> transforms_;
  std::vector<Uncertain> slip_transforms_;
  std::vector<quantities::FirstPassage> passages_;
  std::vector<quantities::Resolvent> resolvents_;
};

}  // namespace

Evaluation by_excursion(const Problem& problem) { return Execution(problem).run(); }

petsc::Analysis analyse(const Problem& problem, const operators::SystemKey& key) {
  operators::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  return systems.analyse(key);
}

}  // namespace stickslip::routes
