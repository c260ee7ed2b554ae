#include "stickslip/studies/study.hpp"

#include <fmt/format.h>

#include "stickslip/effects/effect.hpp"
#include "stickslip/support/errors.hpp"
#include "studies.hpp"

namespace stickslip::studies {

Study run_study(MPI_Comm comm, const cases::Case& given, const options::StudyOptions& study,
                const StudyProgress& progress) {
  const Context context{comm, given, study, progress};
  switch (study.kind) {
  case options::StudyKind::points: return study_points(context);
  case options::StudyKind::steps: return study_steps(context);
  case options::StudyKind::white_noise: return study_white_noise(context);
  case options::StudyKind::heuristic: return study_heuristic(context);
  case options::StudyKind::cost: return study_cost(context);
  case options::StudyKind::none: break;
  }
  return {};
}

quantities::Results scalars(const quantities::Results& results) {
  quantities::Results found;
  for (const auto& result : results) {
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      if (result.value[n] == 0) continue;
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

Run upwind_run(const Context& context, const cases::Case& given, int points, double tail) {
  const auto upwind = upwind_case(given);
  const auto resolution = accuracy::upwind_resolution(upwind.scene, points, tail);
  auto [evaluation, step] = accuracy::solve_on(context.comm, upwind, resolution);
  return {"upwind",
          {{"delta", upwind.scene.delta}, {"p", points}},
          scalars(evaluation.results),
          step.seconds,
          step.statistics};
}

Run converged_run(const Context& context, const cases::Case& given, double accuracy) {
  cases::Case hp = given;
  hp.method = {};
  hp.question.accuracy = accuracy;
  const auto outcome = accuracy::carry_out(context.comm, hp, {}, {});
  double seconds = 0;
  for (const auto& step : outcome.steps) seconds += step.seconds;
  return {"hp",
          {{"delta", hp.scene.delta}, {"accuracy", accuracy}},
          scalars(outcome.results),
          seconds,
          outcome.total};
}

}  // namespace stickslip::studies
