#include "stickslip/petsc/factorization.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <string>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/scalars.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr double kBackwardErrorLimit = 1e-12;
constexpr int kMostRefinementSteps = 2;  // the second only where the first leaves too much

}  // namespace

Factorization::Factorization(Mat matrix, const std::string& prefix, SolverStatistics& statistics,
                             PCType pc_type)
    : measure_(matrix), prefix_(prefix), statistics_(statistics) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  ksp_ = linear_solver(matrix_, prefix_, pc_type);
  factor();
}

void Factorization::factor() {
  double total = 0, symbolic = 0;
  {
    const PhaseTimer timer("factorisation", total);
    const EventTimer analysis("MatLUFactorSym");
    petsc::factor(ksp_, matrix_, prefix_);
    symbolic = analysis.seconds();
  }
  statistics_.analysis_seconds += symbolic;
  statistics_.factorization_seconds += total - symbolic;
  record_factors(ksp_, statistics_);
  ++(kComplex ? statistics_.factorizations_complex : statistics_.factorizations_real);
}

void Factorization::solve_once(Vec b, Vec x) {
  const PhaseTimer timer("solve", statistics_.solve_seconds);
  apply(b, x, false);
  ++statistics_.solves;
}

void Factorization::solve_transposed_once(Vec b, Vec x) {
  const PhaseTimer timer("solve", statistics_.solve_seconds);
  apply(b, x, true);
  ++statistics_.solves;
}

void Factorization::apply(Vec b, Vec x, bool transposed) {
  check(transposed ? KSPSolveTranspose(ksp_, b, x) : KSPSolve(ksp_, b, x));
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(ksp_, &iterations));
  if (iterations > 1) statistics_.iterations += static_cast<int>(iterations);
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp_, &reason));
  if (reason < 0) {
    throw NotReached(fmt::format("the solver -{} stopped: {}{}", prefix_,
                                 KSPConvergedReasons[reason], advice()));
  }
}

Solution Factorization::solve(Vec b, bool transposed) {
  const PhaseTimer timer("solve", statistics_.solve_seconds);
  Solution s;
  VecHandle residual, step;
  for (VecHandle* vector : {&s.x, &s.correction, &residual, &step}) {
    check(VecDuplicate(b, vector->out()));
  }
  check(VecSet(s.correction, 0));
  const auto compute_residual = [&] {
    check(transposed ? MatMultTranspose(matrix_, s.x, residual) : MatMult(matrix_, s.x, residual));
    check(VecAYPX(residual, -1, b));
  };
  apply(b, s.x, transposed);
  ++statistics_.solves;
  bool sound = false;
  for (int n = 0; n < kMostRefinementSteps && !sound; ++n) {
    compute_residual();  // again, as backward_error may overwrite it
    apply(residual, step, transposed);
    check(VecAXPY(s.x, 1, step));
    check(VecAXPY(s.correction, 1, step));
    compute_residual();
    s.backward_error =
        transposed ? measure_.transposed(residual, b, s.x) : measure_.forward(residual, b, s.x);
    sound = s.backward_error <= kBackwardErrorLimit;
    ++statistics_.corrections;
  }
  if (!sound) {
    throw NotReached(fmt::format("the solver -{} left a backward error of {:.1e} (limit {:.0e}){}",
                                 prefix_, s.backward_error, kBackwardErrorLimit, advice()));
  }
  SolverStatistics seen;
  seen.backward_error = s.backward_error;
  statistics_ += seen;
  return s;
}

std::string Factorization::advice() const {
  return is_own(ksp_) ? fmt::format("; -{}pc_type lu exchanges more rows", prefix_) : "";
}

Analysis Factorization::analyse(Mat matrix, const std::string& prefix, SolverStatistics& statistics,
                                PCType pc_type) {
  const PhaseTimer timer("analysis", statistics.analysis_seconds);
  const KspHandle ksp = linear_solver(matrix, prefix, pc_type);
  return petsc::analyse(ksp, matrix, prefix);
}

namespace {

// What a solver of that type reads, on a small matrix.
void read_all_options(const std::string& prefix, PCType pc_type) {
  MatHandle unit;
  check(MatCreate(PETSC_COMM_SELF, unit.out()));
  check(MatSetSizes(unit, 2, 2, 2, 2));
  check(MatSetType(unit, MATAIJ));
  check(MatSetUp(unit));
  for (PetscInt i = 0; i < 2; ++i) check(MatSetValue(unit, i, i, 1, INSERT_VALUES));
  check(MatAssemblyBegin(unit, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(unit, MAT_FINAL_ASSEMBLY));
  const KspHandle ksp = linear_solver(unit, prefix, pc_type);
  const auto amf = default_ordering(prefix);
  if (!is_own(ksp)) check(KSPSetUp(ksp));
}

}  // namespace

void probe_linear_solver(const std::string& prefix) { read_all_options(prefix, PCLU); }

void print_linear_solver_options(const std::string& prefix) {
  check(PetscOptionsSetValue(nullptr, "-help", nullptr));
  read_all_options(prefix, kElementsPc);
  check(PetscOptionsClearValue(nullptr, "-help"));
}

}  // namespace stickslip::petsc
