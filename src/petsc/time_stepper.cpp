#include "stickslip/petsc/time_stepper.hpp"

#include <fmt/format.h>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr double kFirstStep = 1e-8;  // the error control makes it grow at once
constexpr PetscInt kMostSteps = 1000000;

// Called by PETSc: errors go back as codes, exceptions may not pass through it.

// F = u' + A u
PetscErrorCode residual(TS, PetscReal, Vec u, Vec u_dot, Vec f, void* a) {
  PetscErrorCode code = MatMult(static_cast<Mat>(a), u, f);
  if (code == 0) code = VecAXPY(f, 1, u_dot);
  return code;
}

// dF/du + shift dF/du' = A + shift, left alone while the step size stays, and with it the factors.
PetscErrorCode jacobian(TS, PetscReal, Vec, Vec, PetscReal shift, Mat, Mat p, void* context) {
  auto* state = static_cast<TimeStepper::Jacobian*>(context);
  if (shift == state->shift) return 0;
  state->shift = shift;
  PetscErrorCode code = MatCopy(state->a, p, SAME_NONZERO_PATTERN);
  if (code == 0) code = MatShift(p, shift);
  return code;
}

KSP solver_of(TS ts) {
  SNES snes = nullptr;
  KSP ksp = nullptr;
  check(TSGetSNES(ts, &snes));
  check(SNESGetKSP(snes, &ksp));
  return ksp;
}

void configure(TS ts, const std::string& prefix, double tolerance) {
  check(TSSetOptionsPrefix(ts, prefix.c_str()));
  check(TSSetProblemType(ts, TS_LINEAR));
  check(TSSetType(ts, TSARKIMEX));
  check(TSARKIMEXSetType(ts, TSARKIMEX5));
  check(TSARKIMEXSetFullyImplicit(ts, PETSC_TRUE));
  check(TSSetTolerances(ts, tolerance, nullptr, 0, nullptr));  // absolute alone
  check(TSSetTimeStep(ts, kFirstStep));
  check(TSSetMaxSteps(ts, kMostSteps));
  check(TSSetErrorIfStepFails(ts, PETSC_FALSE));
  check(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_MATCHSTEP));
  set_direct_solver(solver_of(ts));
  check(TSSetFromOptions(ts));
}

}  // namespace

TimeStepper::TimeStepper(Mat a, Vec u, const std::string& prefix, double tolerance,
                         SolverStatistics& statistics)
    : prefix_(prefix), statistics_(statistics) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(a)));
  a_ = MatHandle(a);
  check(PetscObjectReference(reinterpret_cast<PetscObject>(u)));
  u_ = VecHandle(u);
  check(MatDuplicate(a, MAT_COPY_VALUES, shifted_.out()));
  jacobian_ = std::make_unique<Jacobian>(Jacobian{a, -1});
  check(TSCreate(PetscObjectComm(reinterpret_cast<PetscObject>(a)), ts_.out()));
  check(TSSetIFunction(ts_, nullptr, residual, a));
  check(TSSetIJacobian(ts_, shifted_, shifted_, jacobian, jacobian_.get()));
  configure(ts_, prefix, tolerance);
  check(TSSetSolution(ts_, u_));
}

void TimeStepper::advance(double time) {
  if (time <= now_) return;
  const PhaseTimer timer("time stepping", statistics_.solve_seconds);
  const auto amf = default_ordering(prefix_);
  check(TSSetMaxTime(ts_, time));
  check(TSSolve(ts_, u_));
  TSConvergedReason reason = TS_CONVERGED_ITERATING;
  check(TSGetConvergedReason(ts_, &reason));
  if (reason != TS_CONVERGED_TIME) {
    throw NotReached(
        fmt::format("the time stepper -{} stopped: {}", prefix_, TSConvergedReasons[reason]));
  }
  PetscInt solves = 0;
  check(TSGetKSPIterations(ts_, &solves));
  statistics_.iterations = static_cast<int>(solves);
  now_ = time;
}

int TimeStepper::steps() const {
  PetscInt steps = 0;
  check(TSGetStepNumber(ts_, &steps));
  return static_cast<int>(steps);
}

void probe_time_stepper(const std::string& prefix) {
  MatHandle unit;
  check(MatCreateAIJ(PETSC_COMM_SELF, 2, 2, 2, 2, 1, nullptr, 0, nullptr, unit.out()));
  for (PetscInt i = 0; i < 2; ++i) check(MatSetValue(unit, i, i, 1, INSERT_VALUES));
  check(MatAssemblyBegin(unit, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(unit, MAT_FINAL_ASSEMBLY));
  VecHandle u;
  check(MatCreateVecs(unit, u.out(), nullptr));
  SolverStatistics statistics;
  check(VecSet(u, 1));
  TimeStepper stepper(unit, u, prefix, 1e-6, statistics);
  check(TSSetTime(stepper.ts_, 0));
  check(TSSetMaxTime(stepper.ts_, kFirstStep));
  check(TSSolve(stepper.ts_, u));  // some options are read by the first step
}

}  // namespace stickslip::petsc
