#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "stickslip/catalogue/displacement_transform_keys.hpp"
#include "stickslip/quantities/displacement_model.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

// At one time, by a model or, where there is none, that of a body that has not moved.
void append_transform(const Computation& computation, double t, const DisplacementModel* model) {
  const auto wavenumbers = computation.question().values(catalogue::kWavenumber.option);
  const auto of = [&](const Row& row) {
    Result result = array(row, wavenumbers);
    result.key = row.key_of(fmt::format("{}", t));
    return result;
  };
  Result cosine = of(catalogue::kDisplacementCosine), sine = of(catalogue::kDisplacementSine);
  const bool even = model::mirrors_itself(computation.process(), computation.question().start);
  for (double k : wavenumbers) {
    DisplacementModel::Transform found{1, 0};
    if (t != 0 && k != 0) found = model->transform(k);
    append_value(cosine, {found.value.real(), found.error});
    append_value(sine, even ? Uncertain{} : Uncertain{found.value.imag(), found.error});
  }
  for (auto* result : {&cosine, &sine}) computation.results().push_back(std::move(*result));
}

void find_transform(Computation& computation) {
  const auto& question = computation.question();
  std::set<double> wavenumbers;
  for (double k : question.values(catalogue::kWavenumber.option)) wavenumbers.insert(std::abs(k));
  wavenumbers.erase(0);
  const double largest = wavenumbers.empty() ? 0 : *wavenumbers.rbegin();
  // At four of them, the largest included.
  std::vector<double> judged;
  const std::size_t count = wavenumbers.size(), stride = (count + 3) / 4;
  for (std::size_t n = 0; const double k : wavenumbers) {
    if ((count - ++n) % stride == 0) judged.push_back(k);
  }
  for (double t : question.time) {
    if (t == 0 || largest == 0) {
      append_transform(computation, t, nullptr);
      continue;
    }
    DisplacementModel model(computation.systems, computation.distribution(), question.start, t,
                            largest);
    for (double k : judged) model.judge(k);
    append_transform(computation, t, &model);
  }
}

}  // namespace

void displacement_transform_tasks(Planner& planner) {
  planner.need_distribution();
  const auto times = static_cast<int>(planner.question().time.size());
  planner.add_adaptive("displacement transform", 8 * times, 200 * times, find_transform);
}

}  // namespace stickslip::quantities
