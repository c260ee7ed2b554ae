#pragma once
/// A case on one discretisation, what is found of it, and what tasks have at hand.

#include <mpi.h>

#include <functional>
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
  /// Why quantities have no results.
  std::map<catalogue::Quantity, std::string> failed = {};
  std::string missed = {};  ///< why some points of others have none
};

/// What the exception in flight says. Throws it again where others must not go on: without memory,
/// for bad input, and on several ranks, of which one may fail alone. Called in a catch block.
[[nodiscard]] std::string reason_to_go_on(MPI_Comm comm);

/// Does the work for a quantity, unless that has failed. What fails there leaves all others alone,
/// as far as reason_to_go_on() allows. Results of a quantity that has failed are of no use.
void attempt(const Problem& problem, Evaluation& evaluation, catalogue::Quantity quantity,
             const std::function<void()>& work);

/// The results of a quantity that has failed, without values, as far as their arguments are known.
[[nodiscard]] Results without_values(const cases::Case& given, catalogue::Quantity quantity,
                                     const std::string& reason);

/// What a task works with, and adds to. Tasks that need the stationary distribution find it there.
struct Computation {
  const Problem& problem;
  operators::Systems& systems;
  Evaluation& found;

  [[nodiscard]] const cases::Question& question() const { return problem.given.question; }
  [[nodiscard]] const model::Process& process() const { return problem.discretisation.process; }
  [[nodiscard]] const StationaryDistribution& distribution() const { return *found.distribution; }
  [[nodiscard]] Results& results() const { return found.results; }
  /// What `find` returns, or `none`, which has no values, where it fails.
  template <class Value, class Find>
  [[nodiscard]] Value value_or(Value none, const Find& find) const {
    try {
      return find();
    } catch (...) {
      found.missed = "has no value: " + reason_to_go_on(problem.comm);
      return none;
    }
  }
  void report(const char* name, double value, std::string_view meaning) const {
    found.checks.push_back({name, value, meaning});
  }
  /// A tenth of the accuracy, so that reduced models do not rule the error.
  [[nodiscard]] ModelTolerance tolerance() const {
    return {0.1 * question().accuracy, problem.recipes};
  }
};

}  // namespace stickslip::quantities
