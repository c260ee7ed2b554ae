#include "stickslip/quantities/laplace.hpp"

#include "stickslip/catalogue/laplace_keys.hpp"
#include "stickslip/operators/static_chain.hpp"

namespace stickslip::quantities {
namespace {

std::vector<double> stick_duration_transforms(const model::Process& process, double lambda) {
  return operators::StaticChain::of(process, lambda).exit_transform();
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

SlidingTransforms sliding_transforms(operators::Systems& systems,
                                     const StationaryDistribution& distribution, double lambda) {
  const auto sticking = stick_duration_transforms(systems.process(), lambda);
  auto& system = systems.at(lambda, operators::symmetry_of(systems.process()));
  const petsc::VecHandle starts = distribution.starts(system.a());
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

}  // namespace stickslip::quantities
