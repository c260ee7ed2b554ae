#include "stickslip/quantities/laplace.hpp"

#include <fmt/format.h>

#include "stickslip/catalogue/laplace_keys.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

std::vector<double> stick_duration_transforms(const model::Process& process, double lambda) {
  return operators::StaticChain::of(process, lambda).exit_transform();
}

void find_duration_moments(Computation& computation) {
  const auto& distribution = computation.distribution();
  const auto entry = distribution.entry();
  const auto moments = duration_moments(computation.systems, distribution, entry);
  append_duration_moments(computation.process(), distribution.starts(), moments, entry,
                          computation.results());
}

}  // namespace

Uncertain stick_transform(const model::Process& process, double lambda,
                          const std::vector<Uncertain>& entry) {
  const auto sticking = stick_duration_transforms(process, lambda);
  Uncertain sum;
  for (std::size_t n = 0; n < sticking.size(); ++n) sum = sum + sticking[n] * entry[n];
  return sum;
}

void append_stick_transform(const model::Process& process, const std::vector<double>& lambda,
                            const std::vector<Uncertain>& entry, Results& results) {
  Result result = array(catalogue::kTransformStick, lambda);
  for (double value : lambda) append_value(result, stick_transform(process, value, entry));
  results.push_back(std::move(result));
}

void stick_transform_tasks(Planner& planner) {
  if (planner.question().wants(catalogue::Quantity::laplace)) return;  // which has it, too
  planner.need_distribution();
  planner.add({"Laplace transforms of sticking phases", {}, [](Computation& computation) {
                 append_stick_transform(computation.process(), computation.question().lambda,
                                        computation.distribution().entry(), computation.results());
               }});
}

SlidingTransforms sliding_transforms(operators::Systems& systems,
                                     const StationaryDistribution& distribution, double lambda) {
  const auto sticking = stick_duration_transforms(systems.process(), lambda);
  auto& system = systems.at(lambda, operators::symmetry_of(systems.process()));
  const petsc::VecHandle starts = distribution.starts_on(system.a());
  const auto transform = [&](const std::vector<double>& values) {
    const std::vector<PetscScalar> s(values.begin(), values.end());
    return value_of(starts, system.factors().solve(system.a().from_static(s)));
  };
  return {transform(std::vector<double>(sticking.size(), 1.0)), transform(sticking)};
}

void append_laplace(const std::vector<double>& lambda,
                    const std::vector<DurationTransforms>& transforms, Results& results) {
  const auto append = [&](const Row& row, Uncertain DurationTransforms::*member) {
    Result result = array(row, lambda);
    for (const auto& t : transforms) append_value(result, t.*member);
    results.push_back(std::move(result));
  };
  append(catalogue::kTransformSlide, &DurationTransforms::slide);
  append(catalogue::kTransformStick, &DurationTransforms::stick);
  append(catalogue::kTransformExcursion, &DurationTransforms::excursion);
}

void laplace_tasks(Planner& planner) {
  planner.need_distribution();
  planner.add({"moments of durations", {{planner.system(), 4, 0}}, find_duration_moments});
  const auto found =
      planner.collect<DurationTransforms>([](const auto& computation, const auto& all) {
        append_laplace(computation.question().lambda, all, computation.results());
      });
  planner.add_at_each_lambda([&](double lambda) -> Task {
    const auto find = [=](Computation& computation) {
      const DurationTransforms none{kNoValue, kNoValue, kNoValue};
      found->push_back(computation.value_or(none, [&]() -> DurationTransforms {
        const auto& distribution = computation.distribution();
        const auto t = sliding_transforms(computation.systems, distribution, lambda);
        const auto stick = stick_transform(computation.process(), lambda, distribution.entry());
        return {t.slide, stick, t.excursion};
      }));
    };
    return {fmt::format("Laplace transforms at lambda = {:g}", lambda),
            {{planner.system(lambda), 2, 0}},
            find};
  });
}

}  // namespace stickslip::quantities
