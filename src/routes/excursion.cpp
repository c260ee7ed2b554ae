#include <cmath>

#include "routes.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/laplace.hpp"
#include "stickslip/quantities/resolvent.hpp"
#include "stickslip/quantities/spectrum.hpp"
#include "stickslip/quantities/transient.hpp"

namespace stickslip::routes {
namespace {

using operators::Symmetry;
using options::Quantity;
using options::Request;
using quantities::Results;
using quantities::StationaryLaw;
using quantities::Uncertain;

bool needs_law(const Request& request) {
  for (Quantity q : {Quantity::sticking, Quantity::moments, Quantity::entry_law, Quantity::density,
                     Quantity::laplace, Quantity::spectrum, Quantity::duration_density,
                     Quantity::autocorrelation, Quantity::expectation}) {
    if (request.wants(q)) return true;
  }
  return request.scene.v_max.has_value();  // what the cut holds back is judged by the law
}

Results results_of(const Request& request, const model::Process& process,
                   const quantities::Excursion& excursion) {
  Results results;
  if (request.wants(Quantity::sticking)) quantities::append_sticking(excursion, results);
  if (request.wants(Quantity::moments)) quantities::append_moments(process, excursion, results);
  if (request.wants(Quantity::entry_law)) {
    quantities::append_entry_law(process, excursion, results);
  }
  return results;
}

// Rounding: the effect of the last correction of the solve, and the defect of an exact identity.
void set_rounding(const StationaryLaw& law, const Results& uncorrected, Results& results) {
  const double defect = law.excursion().conservation_defect(law.process());
  for (std::size_t r = 0; r < results.size(); ++r) {
    auto& result = results[r];
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      const double value = result.value[n];
      result.error[n] = std::abs(value - uncorrected[r].value[n]) + defect * std::abs(value);
    }
  }
}

std::vector<Uncertain> entry_law(const StationaryLaw& law) {
  const auto& p = law.excursion().entry;
  const auto& before = law.uncorrected().entry;
  std::vector<Uncertain> entry;
  for (std::size_t n = 0; n < p.size(); ++n) entry.push_back({p[n], std::abs(p[n] - before[n])});
  return entry;
}

void append_transforms(operators::Systems& systems, const Setting& setting,
                       Evaluation& evaluation) {
  const Request& request = setting.request;
  std::vector<quantities::DurationTransforms> durations;
  std::vector<quantities::Resolvent> resolvents;
  std::vector<Uncertain> entry;
  if (request.wants(Quantity::laplace)) {
    entry = entry_law(*evaluation.law);
    const auto moments = quantities::duration_moments(systems, entry);
    quantities::append_duration_moments(setting.process, moments, entry, evaluation.results);
    if (request.lambda.front() != 0) systems.release(0, Symmetry::even);
  }
  for (double lambda : request.lambda) {
    if (request.wants(Quantity::laplace)) {
      const auto t = quantities::slide_transforms(systems, lambda);
      durations.push_back(
          {t.slide, quantities::stick_transform(setting.process, lambda, entry), t.excursion});
    }
    if (request.wants(Quantity::resolvent)) {
      resolvents.push_back(quantities::resolvent(systems, lambda, request.observables));
    }
    systems.release(lambda, Symmetry::even);
  }
  if (!durations.empty()) {
    quantities::append_laplace(request.lambda, durations, evaluation.results);
  }
  if (!resolvents.empty()) {
    quantities::append_resolvent(request.lambda, request.observables, resolvents,
                                 evaluation.results);
  }
}

// On several ranks each computes the law for itself, then its share of the frequencies.
quantities::Spectrum direct_spectrum(const Setting& setting) {
  const MPI_Comm comm = petsc::ranks(setting.comm) > 1 ? PETSC_COMM_SELF : setting.comm;
  operators::Systems systems(comm, setting.process, setting.axis, setting.ledger);
  const StationaryLaw law(systems);
  systems.release(0, Symmetry::even);
  return quantities::direct_spectrum(setting.comm, systems, law, setting.request.omega);
}

void append_spectrum(operators::Systems& systems, const Setting& setting, Evaluation& evaluation) {
  const Request& request = setting.request;
  if (request.spectrum_solver == options::SpectrumSolver::direct) {
    quantities::append_spectrum(request.omega, direct_spectrum(setting), evaluation.results);
    return;
  }
  // A tenth of the accuracy, so that the projection does not rule the error.
  const auto reduced =
      quantities::reduced_spectrum(systems, *evaluation.law, request.omega, 0.1 * request.accuracy);
  quantities::append_spectrum(request.omega, reduced.spectrum, evaluation.results);
  quantities::append_shape(reduced.shape, evaluation.results);
  evaluation.checks.emplace_back("krylov_pairs", reduced.pairs);
  evaluation.checks.emplace_back("krylov_shifts", static_cast<double>(reduced.shifts.size()));
}

void append_durations(operators::Systems& systems, const Setting& setting, Evaluation& evaluation) {
  const auto& time = setting.request.time;
  const auto& law = *evaluation.law;
  const double tolerance = 0.1 * setting.request.accuracy;
  const auto slide = quantities::slide_law(systems, law, time, tolerance);
  const auto stick = quantities::stick_law(setting.process, entry_law(law), time);
  const auto excursion = quantities::excursion_law(systems, law, time, tolerance);
  quantities::append_duration("slide", time, slide, evaluation.results);
  quantities::append_duration("stick", time, stick, evaluation.results);
  quantities::append_duration("excursion", time, excursion, evaluation.results);
  evaluation.checks.emplace_back("slide_pairs", slide.pairs);
  evaluation.checks.emplace_back("excursion_pairs", excursion.pairs);
}

void append_transients(operators::Systems& systems, const Setting& setting,
                       Evaluation& evaluation) {
  const Request& request = setting.request;
  const double tolerance = 0.1 * request.accuracy;
  const auto method = request.transient_solver == options::TransientSolver::krylov
                          ? quantities::TransientMethod::krylov
                          : quantities::TransientMethod::stepping;
  const auto append = [&](const std::string& key, const std::string& unit,
                          const std::vector<Uncertain>& values) {
    auto result = quantities::array(key, unit, "time", request.time);
    for (const auto& value : values) quantities::append_value(result, value);
    evaluation.results.push_back(std::move(result));
  };
  if (request.wants(Quantity::autocorrelation)) {
    append("C_vv", "velocity^2",
           quantities::autocorrelation(systems, *evaluation.law, request.time, method, tolerance));
  }
  if (!request.wants(Quantity::expectation)) return;
  for (const auto& f : request.observables) {
    const auto expectation =
        quantities::expectation(systems, *evaluation.law, f, {request.start_level, request.start_v},
                                request.time, method, tolerance);
    append("E(" + f.name + ")", "", expectation.value);
    evaluation.results.push_back(
        quantities::scalar("stationary(" + f.name + ")", "", expectation.stationary, 0));
  }
}

}  // namespace

// One set of factors at a time; those for lambda = 0 serve all that needs them first.
Evaluation by_excursion(const Setting& setting) {
  const Request& request = setting.request;
  operators::Systems systems(setting.comm, setting.process, setting.axis, setting.ledger);
  Evaluation evaluation;
  if (needs_law(request)) {
    evaluation.law = std::make_unique<StationaryLaw>(systems);
    // Moments of durations and lambda = 0 at the head of -lambda use these factors again.
    const bool again =
        request.wants(Quantity::laplace) || (!request.lambda.empty() && request.lambda[0] == 0);
    if (!again) systems.release(0, Symmetry::even);
    if (request.wants(Quantity::entry_law)) evaluation.law->orient(systems);
    const auto& law = *evaluation.law;
    evaluation.results = results_of(request, setting.process, law.excursion());
    set_rounding(law, results_of(request, setting.process, law.uncorrected()), evaluation.results);
    if (!(again && request.wants(Quantity::resolvent))) systems.release(0, Symmetry::odd);
  }
  append_transforms(systems, setting, evaluation);
  if (request.wants(Quantity::spectrum)) append_spectrum(systems, setting, evaluation);
  if (request.wants(Quantity::duration_density)) append_durations(systems, setting, evaluation);
  append_transients(systems, setting, evaluation);
  if (request.wants(Quantity::relaxation)) {
    evaluation.even = quantities::relaxation_modes(systems, Symmetry::even);
    evaluation.odd = quantities::relaxation_modes(systems, Symmetry::odd);
    quantities::append_relaxation(Symmetry::even, evaluation.even, evaluation.results);
    quantities::append_relaxation(Symmetry::odd, evaluation.odd, evaluation.results);
  }
  return evaluation;
}

}  // namespace stickslip::routes
