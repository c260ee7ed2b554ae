#pragma once
/// All that is asked for, on one discretisation, by the solution method asked for.

#include <mpi.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/cases/case.hpp"
#include "stickslip/operators/discretisation.hpp"
#include "stickslip/operators/system_key.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/petsc/solver_statistics.hpp"
#include "stickslip/quantities/recipe.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {
class StationaryDistribution;
}

namespace stickslip::routes {

/// A case on one discretisation.
struct Problem {
  MPI_Comm comm;
  const cases::Case& given;
  operators::Discretisation discretisation;
  petsc::SolverStatistics& statistics;
  /// Of reduced models, from one refinement level to the next.
  std::shared_ptr<quantities::Recipes> recipes = std::make_shared<quantities::Recipes>();
  /// By frequencies whose waves need elements of their own.
  std::map<double, operators::Discretisation> waves = {};
};

struct Evaluation {
  /// Errors are those of the solution method on this discretisation: rounding, and the bias of
  /// small lambda.
  quantities::Results results;
  /// What the solution method reports of itself, by name, such as the lambda it used.
  std::vector<std::pair<std::string, double>> checks;
  std::shared_ptr<quantities::StationaryDistribution>
      distribution;                                 ///< of method excursion, if it was needed
  std::vector<quantities::RelaxationSector> modes;  ///< if asked for
};

/// Assembles, factors and solves what the question needs and nothing else. Collective. Throws
/// NotReached or NoMemory.
[[nodiscard]] Evaluation evaluate(const Problem& problem);

/// Assembles the system of a key and has its solver analyse it; nothing is factored. Sizes and
/// times go to the statistics. Collective. Throws NoMemory.
[[nodiscard]] petsc::Analysis analyse(const Problem& problem, const operators::SystemKey& key);

}  // namespace stickslip::routes
