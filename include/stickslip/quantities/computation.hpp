#pragma once
/// A case on one discretisation, what is found of it, and what tasks have at hand.

#include <mpi.h>

#include <map>
#include <memory>
#include <vector>

#include "stickslip/cases/case.hpp"
#include "stickslip/operators/discretisation.hpp"
#include "stickslip/petsc/solver_statistics.hpp"
#include "stickslip/quantities/recipe.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

class StationaryDistribution;

/// A case on one discretisation.
struct Problem {
  MPI_Comm comm;
  const cases::Case& given;
  operators::Discretisation discretisation;
  petsc::SolverStatistics& statistics;
  /// Of reduced models, from one refinement level to the next.
  std::shared_ptr<Recipes> recipes = std::make_shared<Recipes>();
  /// By frequencies whose waves need elements of their own.
  std::map<double, operators::Discretisation> waves = {};
};

struct Evaluation {
  /// Errors are those of the solution method on this discretisation: rounding, and the bias of
  /// small lambda.
  Results results;
  std::vector<Check> checks;  ///< what the solution method reports of itself
  std::shared_ptr<StationaryDistribution> distribution;  ///< of method excursion, if it was needed
  std::vector<RelaxationSector> modes;                   ///< if asked for
};

/// What a task works with, and adds to. Tasks that need the stationary distribution find it there.
struct Computation {
  const Problem& problem;
  operators::Systems& systems;
  Evaluation& found;

  [[nodiscard]] const cases::Question& question() const { return problem.given.question; }
  [[nodiscard]] const model::Process& process() const { return problem.discretisation.process; }
  [[nodiscard]] const StationaryDistribution& distribution() const { return *found.distribution; }
  [[nodiscard]] Results& results() const { return found.results; }
  void report(const char* name, double value, std::string_view meaning) const {
    found.checks.push_back({name, value, meaning});
  }
  /// A tenth of the accuracy, so that reduced models do not rule the error.
  [[nodiscard]] ModelTolerance tolerance() const {
    return {0.1 * question().accuracy, problem.recipes};
  }
};

}  // namespace stickslip::quantities
