#include <fmt/format.h>

#include <complex>

#include "stickslip/catalogue/displacement_transform_keys.hpp"
#include "stickslip/quantities/displacement_model.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

void find_transform(Computation& computation) {
  const auto& question = computation.question();
  const auto wavenumbers = question.values(catalogue::kWavenumber.option);
  const bool even = model::mirrors_itself(computation.process(), question.start);
  for (double t : question.time) {
    const auto of = [&](const Row& row) {
      Result result = array(row, wavenumbers);
      result.key = row.key_of(fmt::format("{}", t));
      return result;
    };
    Result cosine = of(catalogue::kDisplacementCosine), sine = of(catalogue::kDisplacementSine);
    DisplacementModel model(computation.systems, computation.distribution(), question.start, t,
                            computation.tolerance().value);
    for (double k : wavenumbers) {
      DisplacementModel::Transform found{1, 0};
      if (t != 0 && k != 0) found = model.at(k);
      append_value(cosine, {found.value.real(), found.error});
      append_value(sine, even ? Uncertain{} : Uncertain{found.value.imag(), found.error});
    }
    for (auto* result : {&cosine, &sine}) computation.results().push_back(std::move(*result));
  }
}

}  // namespace

void displacement_transform_tasks(Planner& planner) {
  planner.need_distribution();
  const auto& question = planner.question();
  const auto& wavenumbers = question.values(catalogue::kWavenumber.option);
  resolve_displacements(planner, largest_size(wavenumbers));
  const auto count = static_cast<int>(question.time.size() * wavenumbers.size());
  planner.add_adaptive("displacement transform", 2 * count, 50 * count, find_transform);
}

}  // namespace stickslip::quantities
