#pragma once
/// Refinement of a discretisation until every number asked for is as accurate as asked for.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/linalg/solver_statistics.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/run/campaign.hpp"
#include "stickslip/run/discretise.hpp"
#include "stickslip/run/estimates.hpp"
#include "stickslip/run/routes.hpp"
#include "stickslip/simulation/walk.hpp"

namespace stickslip::run {

// Discretisations in the order in which refinement tries them.

/// Refinement levels below 1 only serve for comparison; each further refinement level is finer in
/// degrees or points and noise nodes, so that the change from one refinement level to the next
/// shows the error of the coarser one. All have the same elements, as they reach as far: how the
/// errors of two levels on other elements compare is at random. What is cut off is an error of its
/// own (Resolution::truncation). Where the tail may weigh anything, as what observables, first
/// passages and relaxation modes make of it, each level reaches further than the one before
/// instead.
class RefinementSequence {
 public:
  explicit RefinementSequence(const cases::Case& given);

  /// Number of the first refinement level: -1, or 0 where the order of convergence is known or
  /// there is nothing coarser.
  [[nodiscard]] int first() const;
  /// Number of the last refinement level that may be tried.
  [[nodiscard]] int last() const { return last_; }
  [[nodiscard]] const Resolution& refinement_level(int n) const;

  /// How the error of refinement level n >= 1 follows from changes.
  [[nodiscard]] ErrorPerChange error_per_change(int n) const;
  /// Whether the error falls only as a power of the unknowns.
  [[nodiscard]] bool first_order() const { return method_.scheme == cases::Scheme::upwind; }
  /// Truncation error allowed on refinement level n, relative.
  [[nodiscard]] double tail_tolerance(int n) const;

 private:
  [[nodiscard]] int free_refinement_levels() const;
  [[nodiscard]] Resolution made(int n) const;
  [[nodiscard]] generator::Grouping grouping(int n) const;
  [[nodiscard]] std::vector<double> waves(int n) const;
  [[nodiscard]] int degree(int n) const;
  [[nodiscard]] int points(int n) const;

  model::Scene scene_;
  cases::Method method_;
  double accuracy_;
  quantities::Needs needs_;
  std::vector<double> waves_;  // frequencies of needs_ that leave waves
  int first_degree_ = 0;       // of refinement level 1
  generator::Integrands integrands_;
  int branches_ = 1;
  bool all_levels_ = false;   // every noise level is a node
  bool tail_counts_ = false;  // what is asked for may weigh the tail anyhow
  bool table_ = false;        // the noise has levels of its own
  int last_;
  mutable std::map<int, Resolution> refinement_levels_;  // those asked for so far
};

/// One discretisation that was solved, with what it cost and how accurate it was.
struct Step {
  Resolution resolution;
  linalg::SolverStatistics statistics;
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
  Evaluation evaluation;  ///< errors are those of the solution method on this discretisation alone
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
  linalg::SolverStatistics total;
  std::optional<Simulated> simulation;   ///< of -route monte_carlo
  std::optional<simulation::Path> path;  ///< of trajectory
  std::optional<Comparison> comparison;  ///< of -compare
};

/// Called before each step with its number, its resolution and the seconds it is expected to take
/// (0 for a small first one). Given on all ranks or on none.
using Progress = std::function<void(int, const Resolution&, double)>;

/// What takes a discretisation, along the refinement sequence of the case; the error estimate of a
/// value is that of add_discretisation() and the error of the solution method on this
/// discretisation, mostly rounding; see Evaluation. Stops when every scalar meets the
/// accuracy, when rounding forbids it, or at the end of the refinement sequence. Collective. Throws
/// NoMemory before anything is allocated that would not fit, NotReached when a solver fails.
[[nodiscard]] Outcome refine(MPI_Comm comm, const cases::Case& given, const Progress& progress);

/// What to take in the place of the accuracy that an outcome has missed, after "; ", once a run has
/// met it; empty if nothing is attainable. As long as looser runs take. Collective.
[[nodiscard]] std::string tried_accuracy(MPI_Comm comm, const cases::Case& given,
                                         const Outcome& outcome);

}  // namespace stickslip::run
