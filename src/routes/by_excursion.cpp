#include <optional>
#include <vector>

#include "routes.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::routes {

Evaluation by_excursion(const Problem& problem) {
  Evaluation evaluation;
  operators::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  quantities::Computation computation{problem, systems, evaluation};
  const quantities::Plan plan = quantities::plan_of(problem.given);
  std::vector<std::optional<catalogue::Quantity>> owners;  // of the results
  const auto carry_out = [&](const quantities::Task& task) {
    const auto work = [&] { task.carry_out(computation); };
    if (task.quantity) quantities::attempt(problem, evaluation, *task.quantity, work);
    if (!task.quantity) work();
    owners.resize(evaluation.results.size(), task.quantity);
  };
  for (std::size_t n = 0; n < plan.tasks.size(); ++n) {
    carry_out(plan.tasks[n]);
    systems.keep(plan.used_from(n + 1));
  }
  for (const auto& task : plan.afterwards) carry_out(task);
  std::size_t at = 0;
  std::erase_if(evaluation.results, [&](const auto&) {
    const auto owner = owners[at++];
    return owner && evaluation.failed.contains(*owner);
  });
  for (auto& result : evaluation.results) {
    const bool complete = evaluation.missed.empty() || quantities::all_numbers(result);
    if (!complete) result.unreached = evaluation.missed;
  }
  return evaluation;
}

petsc::Analysis analyse(const Problem& problem, const operators::SystemKey& key) {
  operators::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  return systems.analyse(key);
}

}  // namespace stickslip::routes
