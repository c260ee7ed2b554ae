#include "routes.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::routes {

Evaluation by_excursion(const Problem& problem) {
  Evaluation evaluation;
  operators::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  quantities::Computation computation{problem, systems, evaluation};
  const quantities::Plan plan = quantities::plan_of(problem.given);
  for (std::size_t n = 0; n < plan.tasks.size(); ++n) {
    plan.tasks[n].carry_out(computation);
    systems.keep(plan.used_from(n + 1));
  }
  for (const auto& append : plan.afterwards) append(computation);
  return evaluation;
}

petsc::Analysis analyse(const Problem& problem, const operators::SystemKey& key) {
  operators::Systems systems(problem.comm, problem.discretisation, problem.statistics);
  return systems.analyse(key);
}

}  // namespace stickslip::routes
