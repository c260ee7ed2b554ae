#pragma once
/// Refinement of a discretisation until every number asked for is as accurate as asked for.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stickslip/accuracy/comparison.hpp"
#include "stickslip/accuracy/resolution.hpp"
#include "stickslip/cases/case.hpp"
#include "stickslip/monte_carlo/simulate.hpp"
#include "stickslip/petsc/solver_statistics.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/routes/evaluation.hpp"
#include "stickslip/simulation/path.hpp"

namespace stickslip::accuracy {

/// One discretisation that was solved, with what it cost and how accurate it was.
struct Step {
  Resolution resolution;
  petsc::SolverStatistics statistics;
  double seconds = 0;        ///< wall time of the whole step
  double estimate = 0;       ///< largest relative error estimate of a scalar; 0 if none yet
  std::string limiting_key;  ///< the scalar that has it
  std::vector<quantities::Check> checks;  ///< what the solution method reports of itself
};

/// By how much the predicted need of memory exceeds what is free, and what would help; empty if it
/// does not. Collective.
[[nodiscard]] std::string shortfall_of_memory(MPI_Comm comm, const model::Scene& scene,
                                              const Resolution& resolution);
/// Throws NoMemory with these words. Collective.
void require_memory(MPI_Comm comm, const model::Scene& scene, const Resolution& resolution);

/// What is asked for on one discretisation.
struct Solved {
  routes::Evaluation
      evaluation;  ///< errors are those of the solution method on this discretisation alone
  Step step;
};

/// Solves a case on one discretisation. Collective. Throws NoMemory before anything
/// is allocated that would not fit, NotReached when a solver fails.
[[nodiscard]] Solved solve_on(MPI_Comm comm, const cases::Case& given,
                              const Resolution& resolution);

struct Outcome {
  /// Values of the last step, with their error estimates.
  quantities::Results results;
  std::vector<quantities::RelaxationSector> modes;  ///< if asked for
  std::optional<quantities::DensityField> density;  ///< if asked for
  double speed_error = 0;  ///< of the distribution function of |V|, if the density is asked for
  bool reached = false;    ///< whether all estimates are within the accuracy
  std::string shortfall;   ///< why not, and what would help
  /// The accuracy that a looser demand may meet, where rounding limits the one asked for; 0: none.
  double attainable = 0;
  /// Why quantities have no values, or those of a coarser discretisation.
  std::string failures;
  double next_digit_seconds = 0;  ///< predicted time of a run at a tenth of the error; 0: unknown
  std::vector<Step> steps;
  petsc::SolverStatistics total;
  std::optional<monte_carlo::Simulated> simulation;  ///< of -route monte_carlo
  std::optional<simulation::Path> path;              ///< of trajectory
  std::optional<Comparison> comparison;              ///< of -compare
};

/// Called before each step with its number, its resolution and the seconds it is expected to take
/// (0 for a small first one). Given on all ranks or on none.
using Progress = std::function<void(int, const Resolution&, double)>;

/// What takes a discretisation, along the refinement sequence of the case; the error estimate of a
/// value is that of add_discretisation() and the error of the solution method on this
/// discretisation, mostly rounding; see routes::Evaluation. Stops when every scalar meets the
/// accuracy, when rounding forbids it, or at the end of the refinement sequence. Collective. Throws
/// NoMemory before anything is allocated that would not fit, NotReached when a solver fails.
[[nodiscard]] Outcome refine(MPI_Comm comm, const cases::Case& given, const Progress& progress);

/// What to take in the place of the accuracy that an outcome has missed, after "; ", once a run has
/// met it; empty if nothing is attainable. As long as looser runs take. Collective.
[[nodiscard]] std::string tried_accuracy(MPI_Comm comm, const cases::Case& given,
                                         const Outcome& outcome);

}  // namespace stickslip::accuracy
