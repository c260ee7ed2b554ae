#include "stickslip/petsc/solver_statistics.hpp"

#include <petsclog.h>
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

double logged_seconds(const char* event) {
  PetscLogEvent id = -1;
  check(PetscLogEventGetId(event, &id));
  PetscStageLog log = nullptr;
  check(PetscLogGetStageLog(&log));
  double seconds = 0;
  for (int stage = 0; stage < log->numStages; ++stage) {
    PetscEventPerfInfo info{};
    check(PetscLogEventGetPerfInfo(stage, id, &info));
    seconds += info.time;
  }
  return seconds;
}

}  // namespace stickslip::petsc
