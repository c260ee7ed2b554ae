#pragma once
/// u' = -A u, implicit and adaptive.

#include <petscts.h>

#include <memory>
#include <string>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/petsc/solver_statistics.hpp"

namespace stickslip::petsc {

using TsHandle = Handle<TS, TSDestroy>;

/// PETSc's TS for a linear equation: diagonally implicit Runge-Kutta steps of order 5 (ARKIMEX, all
/// of it implicit), their sizes chosen by its error control, linear systems factored by MUMPS.
/// Every choice is an option under the prefix, e.g. -transient_ts_type rosw or
/// -transient_ts_monitor. All members are collective.
class TimeStepper {
 public:
  /// Starts at u(0) = `u`, which holds the solution from then on. `tolerance` is absolute, for each
  /// step. `a` is kept by reference count. Times and counts go to `statistics`, which must outlive
  /// this.
  TimeStepper(Mat a, Vec u, const std::string& prefix, double tolerance,
              SolverStatistics& statistics);

  /// Advances to `time`, not before the present one. Throws NotReached when steps fail.
  void advance(double time);

  [[nodiscard]] int steps() const;

  /// A with the shift for which A + shift is at hand; only for the callbacks.
  struct Jacobian {
    Mat a;
    double shift;
  };

 private:
  friend void probe_time_stepper(const std::string& prefix);

  MatHandle a_, shifted_;
  std::unique_ptr<Jacobian> jacobian_;
  VecHandle u_;
  TsHandle ts_;
  std::string prefix_;
  SolverStatistics& statistics_;
  double now_ = 0;
};

}  // namespace stickslip::petsc
