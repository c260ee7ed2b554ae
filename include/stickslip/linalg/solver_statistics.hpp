#pragma once
/// What was really done: counts, sizes and wall time by phase.

#include <petsclog.h>

#include <cstdint>

namespace stickslip::linalg {

/// Counts and wall seconds of the work done under it. Copied per refinement step and summed.
struct SolverStatistics {
  int assemblies = 0;
  int factorizations_real = 0;
  int factorizations_complex = 0;
  int solves = 0;       ///< right-hand sides solved for, forward or transposed
  int corrections = 0;  ///< steps of iterative refinement, which correct or measure rounding
  int iterations = 0;   ///< of iterative solvers, all solves together

  std::int64_t unknowns = 0;        ///< of the largest system
  std::int64_t nonzeros = 0;        ///< of the largest matrix
  std::int64_t factor_entries = 0;  ///< of the largest factorisation; 0 if the solver hides it
  double factor_megabytes = 0;      ///< memory of the largest factorisation, all ranks
  double backward_error = 0;        ///< largest backward error after iterative refinement

  double assembly_seconds = 0;
  double analysis_seconds = 0;
  double factorization_seconds = 0;
  double solve_seconds = 0;

  /// Adds counts and times, keeps the larger sizes.
  SolverStatistics& operator+=(const SolverStatistics& other);
  [[nodiscard]] double seconds() const {
    return assembly_seconds + analysis_seconds + factorization_seconds + solve_seconds;
  }
};

/// Wall clock [s], of which differences count. Local.
[[nodiscard]] double wall_seconds();

/// Adds the wall time of a scope to a statistics entry and shows it as a stage of -log_view.
class PhaseTimer {
 public:
  /// `stage`: name of the stage, registered at first use.
  PhaseTimer(const char* stage, double& seconds);
  ~PhaseTimer();
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;

 private:
  double& seconds_;
  double start_;
};

/// Wall seconds that PETSc logs from here on for an event such as "MatLUFactorSym", in the stage
/// that is current when it is asked for, which has to be the one of the construction. Local.
class EventTimer {
 public:
  explicit EventTimer(const char* event);
  [[nodiscard]] double seconds() const;

 private:
  PetscLogEvent event_ = -1;
  double before_ = 0;
};

}  // namespace stickslip::linalg
