#include "stickslip/petsc/solver_statistics.hpp"

#include <petsctime.h>

#include <algorithm>

#include "stickslip/petsc/check.hpp"

namespace stickslip::petsc {
namespace {

PetscLogStage stage_named(const char* name) {
  PetscLogStage stage = -1;
  check(PetscLogStageGetId(name, &stage));
  if (stage < 0) check(PetscLogStageRegister(name, &stage));
  return stage;
}

// So far, in the current stage.
double logged_seconds(PetscLogEvent event) {
  PetscEventPerfInfo info{};
  check(PetscLogEventGetPerfInfo(PETSC_DETERMINE, event, &info));
  return info.time;
}

}  // namespace

double wall_seconds() {
  PetscLogDouble seconds = 0;
  check(PetscTime(&seconds));
  return seconds;
}

SolverStatistics& SolverStatistics::operator+=(const SolverStatistics& other) {
  assemblies += other.assemblies;
  factorizations_real += other.factorizations_real;
  factorizations_complex += other.factorizations_complex;
  solves += other.solves;
  corrections += other.corrections;
  iterations += other.iterations;
  unknowns = std::max(unknowns, other.unknowns);
  nonzeros = std::max(nonzeros, other.nonzeros);
  factor_entries = std::max(factor_entries, other.factor_entries);
  factor_megabytes = std::max(factor_megabytes, other.factor_megabytes);
  backward_error = std::max(backward_error, other.backward_error);
  assembly_seconds += other.assembly_seconds;
  analysis_seconds += other.analysis_seconds;
  factorization_seconds += other.factorization_seconds;
  solve_seconds += other.solve_seconds;
  return *this;
}

PhaseTimer::PhaseTimer(const char* stage, double& seconds)
    : seconds_(seconds), start_(wall_seconds()) {
  check(PetscLogStagePush(stage_named(stage)));
}

PhaseTimer::~PhaseTimer() {
  PetscLogDouble end = start_;
  (void)PetscTime(&end);
  seconds_ += end - start_;
  (void)PetscLogStagePop();
}

EventTimer::EventTimer(const char* event) {
  check(PetscLogEventGetId(event, &event_));
  before_ = logged_seconds(event_);
}

double EventTimer::seconds() const { return logged_seconds(event_) - before_; }

}  // namespace stickslip::petsc
