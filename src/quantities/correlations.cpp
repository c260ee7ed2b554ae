#include "stickslip/quantities/correlations.hpp"

#include <cmath>

#include "stickslip/case/spectrum_rows.hpp"

namespace stickslip::quantities {
namespace {

using generator::KolmogorovOperator;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;
using linalg::dot;

// c exp(L t) b; errors in units of `unit`.
std::vector<Uncertain> curve(const std::string& name, const model::Process& process,
                             const StationaryDistribution& distribution, ProcessPencil& pencil,
                             Vec b, Vec c, ReducedModel::Nature nature,
                             const std::vector<double>& time, double unit,
                             const ModelTolerance& tolerance) {
  const linalg::VecHandle weight = distribution.weight_on(pencil.a());
  return time_curve(pencil, {b, c, weight}, nature, {{0, unit}}, time, time_scales(process),
                    tolerance.value, tolerance.recipe(name))
      .value[0];
}

void find_autocorrelation(Computation& computation) {
  const auto& time = computation.question().time;
  const auto values = autocorrelation(computation.systems, computation.distribution(), time,
                                      computation.tolerance());
  append_array(array(cases::kAutocovariance, time), values, computation.results());
}

void find_expectations(Computation& computation) {
  const auto& question = computation.question();
  for (const auto& f : question.observables) {
    const auto found = expectation(computation.systems, computation.distribution(), f,
                                   question.start, question.time, computation.tolerance());
    auto& results = computation.results();
    append_array(array(blank(cases::kExpectationOf, f), question.time), found.value, results);
    results.push_back(scalar(blank(cases::kStationaryOf, f), found.stationary, found.unseen));
  }
}

}  // namespace

ReducedModel::Nature nature_of(const model::Start& start) {
  const bool one_state = start.kind == model::Start::Kind::state;
  return one_state ? ReducedModel::Nature::kinked : ReducedModel::Nature::rough;
}

linalg::VecHandle start_on(const KolmogorovOperator& a, const model::Start& start) {
  return a.mean_at(model::levels_at(a.discretisation().process.noise, start), start.v);
}

bool counts(Vec functional) {
  constexpr double rounding = 1e-15;
  return linalg::norm(functional, NORM_INFINITY) > rounding;
}

std::vector<Uncertain> autocorrelation(generator::Systems& systems,
                                       const StationaryDistribution& distribution,
                                       const std::vector<double>& time,
                                       const ModelTolerance& tolerance) {
  ProcessPencil whole(systems, distribution.velocity_symmetry(), StaticPhase::kept);
  const auto velocity = distribution.velocity(whole.a());
  const double variance = dot(velocity.c, velocity.b);
  return curve("autocorrelation", systems.process(), distribution, whole, velocity.b, velocity.c,
               ReducedModel::Nature::smooth, time, variance, tolerance);
}

Expectation expectation(generator::Systems& systems, const StationaryDistribution& distribution,
                        const model::Observable& f, const model::Start& start,
                        const std::vector<double>& time, const ModelTolerance& tolerance) {
  Expectation result;
  result.value.resize(time.size());
  double unseen = 0;
  for (Symmetry symmetry : generator::sectors_of(systems.process())) {
    ProcessPencil whole(systems, symmetry, StaticPhase::kept);
    const KolmogorovOperator& a = whole.a();
    // Without its odd part, where states of both signs are kept although that has no mean.
    const bool even = symmetry == Symmetry::none && model::mirrors_itself(systems.process(), start);
    const auto part = generator::part_of(f, even ? Symmetry::even : symmetry);
    const bool rough = f.formula != nullptr;
    const linalg::VecHandle b = a.values(part, rough);
    const linalg::VecHandle pi = distribution.occupation_on(a);
    check(VecScale(pi, 1 / distribution.excursion().mean_excursion()));
    const double unit = std::sqrt(std::abs(dot(pi, linalg::product(b, b))));
    const double overlooked = std::abs(dot(pi, a.overlooked(part)));
    unseen += overlooked;
    if (symmetry != Symmetry::odd) {
      const auto mean = generator::part_with_mean(f, systems.process());
      result.stationary = dot(pi, a.values(mean, rough));
      result.unseen = std::abs(dot(pi, a.overlooked(mean)));
    }
    if (unit == 0) continue;
    if (start.kind == model::Start::Kind::stationary) {
      for (auto& value : result.value) value = {result.stationary, 0};
      continue;
    }
    const linalg::VecHandle c = start_on(a, start);
    if (!counts(c)) continue;  // as odd functions at rest at x = 0
    const std::string name = "E(" + f.name + ")" + std::to_string(static_cast<int>(symmetry));
    const auto of_part = curve(name, systems.process(), distribution, whole, b, c, nature_of(start),
                               time, unit, tolerance);
    for (std::size_t n = 0; n < time.size(); ++n) result.value[n] = result.value[n] + of_part[n];
  }
  for (auto& value : result.value) value.error += unseen;
  return result;
}

void autocorrelation_tasks(Planner& planner) {
  planner.need_distribution();
  planner.add_adaptive("autocorrelation", 6, 36, find_autocorrelation);
}

void expectation_tasks(Planner& planner) {
  planner.need_distribution();
  const auto observables = static_cast<int>(planner.question().observables.size());
  planner.add_adaptive("expectations", 6 * observables, 36 * observables, find_expectations);
}

}  // namespace stickslip::quantities
