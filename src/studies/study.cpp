#include "stickslip/studies/study.hpp"

#include <fmt/format.h>

#include "stickslip/effects/effect.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/support/errors.hpp"
#include "studies.hpp"

namespace stickslip::studies {

Study run_study(MPI_Comm comm, const cases::Case& given, const options::StudyOptions& study,
                const StudyProgress& progress) {
  const Context context{comm, given, study, progress};
  const std::pair<options::StudyKind, Study (*)(const Context&)> all[] = {
      {options::StudyKind::points, study_points},
      {options::StudyKind::steps, study_steps},
      {options::StudyKind::white_noise, study_white_noise},
      {options::StudyKind::heuristic, study_heuristic},
      {options::StudyKind::cost, study_cost}};
  Study found;
  for (const auto& [kind, carry_out] : all) {
    if (kind == study.kind) found = carry_out(context);
  }
  for (const auto& run : found.runs) {
    if (run.failure.empty()) continue;
    found.complete = false;
    const auto& [parameter, value] = run.parameters.front();
    found.conclusions.push_back(
        fmt::format("{}, {} = {:g}: {}", run.method, parameter, value, run.failure));
  }
  return found;
}

quantities::Results scalars(const quantities::Results& results) {
  quantities::Results found;
  for (const auto& result : results) {
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      const bool asked = !result.diagnostic || !result.is_scalar();
      if (result.value[n] == 0 || !asked) continue;
      auto& one = found.emplace_back(result);
      if (!result.is_scalar()) {
        one.key += fmt::format(" {}={:g}", result.abscissa_name, result.abscissa[n]);
      }
      one.abscissa_name.clear();
      one.abscissa.clear();
      one.value = {result.value[n]};
      one.error = {result.error[n]};
      if (!result.ci95.empty()) one.ci95 = {result.ci95[n]};
    }
  }
  return found;
}

double value_of(const quantities::Results& results, const std::string& key) {
  for (const auto& result : results) {
    if (result.key == key) return result.value[0];
  }
  return kNone;
}

void set_errors(const quantities::Results& known, quantities::Results& results) {
  for (auto& result : results) {
    const double value = value_of(known, result.key);
    if (!std::isnan(value)) result.error[0] = std::abs(result.value[0] - value);
  }
}

cases::Case with_delta(const cases::Case& given, double delta) {
  cases::Case other = given;
  other.scene.delta = delta;
  effects::make_noise_levels(other.scene);
  other.scene.noise_levels.reset();
  other.method = {};
  return other;
}

namespace {

cases::Case upwind_case(const cases::Case& given) {
  cases::Case upwind = given;
  upwind.method = {};
  upwind.method.scheme = cases::Scheme::upwind;
  return upwind;
}

}  // namespace

void require_upwind_memory(const Context& context, const cases::Case& given, int points,
                           double tail) {
  const auto upwind = upwind_case(given);
  try {
    accuracy::require_memory(context.comm, upwind.scene,
                             accuracy::upwind_resolution(upwind.scene, points, tail));
  } catch (const NoMemory& lack) {
    const bool fixed = context.study.kind == options::StudyKind::heuristic;
    throw NoMemory(fmt::format("upwind with p = {}, delta = {:g}: {}{}", points, upwind.scene.delta,
                               lack.what(), fixed ? "" : ", or fewer -study_steps"));
  }
}

Run attempted(MPI_Comm comm, Run run, const std::function<void(Run&)>& find) {
  try {
    find(run);
  } catch (...) {
    const Failure failure = petsc::failure_in_flight();
    if (petsc::ranks(comm) > 1) throw;  // of which one may fail alone
    run.failure = failure.what();
  }
  return run;
}

Run upwind_run(const Context& context, const cases::Case& given, int points, double tail) {
  const auto upwind = upwind_case(given);
  return attempted(
      context.comm, {"upwind", {{"delta", upwind.scene.delta}, {"p", points}}}, [&](Run& run) {
        const auto resolution = accuracy::upwind_resolution(upwind.scene, points, tail);
        auto [evaluation, step] = accuracy::solve_on(context.comm, upwind, resolution);
        run.results = scalars(evaluation.results);
        run.seconds = step.seconds;
        run.statistics = step.statistics;
      });
}

Run converged_run(const Context& context, const cases::Case& given, double accuracy) {
  cases::Case hp = given;
  hp.method = {};
  hp.question.accuracy = accuracy;
  return attempted(context.comm, {"hp", {{"delta", hp.scene.delta}, {"accuracy", accuracy}}},
                   [&](Run& run) {
                     const auto outcome = accuracy::carry_out(context.comm, hp, {}, {});
                     for (const auto& step : outcome.steps) run.seconds += step.seconds;
                     run.results = scalars(outcome.results);
                     run.statistics = outcome.total;
                     run.failure = outcome.failures;
                   });
}

}  // namespace stickslip::studies
