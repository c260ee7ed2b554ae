#include "stickslip/petsc/eigensolver.hpp"

#include <fmt/format.h>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr bool kComplex = PetscDefined(USE_COMPLEX);
constexpr double kTolerance = 1e-13;

KSP solver_of(EPS eps) {
  ST st = nullptr;
  check(EPSGetST(eps, &st));
  KSP ksp = nullptr;
  check(STGetKSP(st, &ksp));
  return ksp;
}

// One eigenvalue next to the target comes with the first few vectors, and each costs a solve. How
// many are wanted, and in which space, the user may have changed.
void keep_space_small_for_one(EPS eps) {
  PetscInt wanted = 0, space = 0, projected = 0;
  check(EPSGetDimensions(eps, &wanted, &space, &projected));
  const bool open = space < 0 && projected < 0;  // by a constant of PETSc, another from 3.22 on
  if (wanted == 1 && open) check(EPSSetDimensions(eps, 1, 4, PETSC_DEFAULT));
}

EpsHandle configured_eigensolver(Mat matrix, const std::string& prefix, double target, int wanted) {
  EpsHandle eps;
  check(EPSCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), eps.out()));
  check(EPSSetOptionsPrefix(eps, prefix.c_str()));
  check(EPSSetOperators(eps, matrix, nullptr));
  check(EPSSetProblemType(eps, EPS_NHEP));
  check(EPSSetDimensions(eps, wanted, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSetTolerances(eps, kTolerance, PETSC_DEFAULT));
  check(EPSSetTarget(eps, target));
  check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  ST st = nullptr;
  check(EPSGetST(eps, &st));
  check(STSetType(st, STSINVERT));
  set_direct_solver(solver_of(eps));
  // Each rank would solve the small projected problem by itself, to other last bits where its
  // memory lies otherwise, and one that finds it converged would leave the others waiting.
  DS projected = nullptr;
  check(EPSGetDS(eps, &projected));
  check(DSSetParallel(projected, DS_PARALLEL_SYNCHRONIZED));
  check(EPSSetFromOptions(eps));
  keep_space_small_for_one(eps);
  return eps;
}

}  // namespace

Eigensolver::Eigensolver(Mat matrix, const std::string& prefix, double target, int wanted,
                         SolverStatistics& statistics)
    : matrix_(matrix), prefix_(prefix) {
  double total = 0, symbolic = 0, numeric = 0;
  {
    const PhaseTimer timer("eigenvalues", total);
    const EventTimer analysis("MatLUFactorSym"), factoring("MatLUFactorNum");
    eps_ = configured_eigensolver(matrix, prefix, target, wanted);
    const DefaultOrdering amf(prefix + "st_");
    check(EPSSetUp(eps_));
    require_factored(solver_of(eps_), prefix + "st_");
    check(EPSSolve(eps_));
    collect_pairs();
    symbolic = analysis.seconds();
    numeric = factoring.seconds();
  }
  statistics.analysis_seconds += symbolic;
  statistics.factorization_seconds += numeric;
  statistics.solve_seconds += total - symbolic - numeric;
  ++(kComplex ? statistics.factorizations_complex : statistics.factorizations_real);
  PetscInt solves = 0;
  check(KSPGetTotalIterations(solver_of(eps_), &solves));
  statistics.solves += static_cast<int>(solves);
  record_factors(solver_of(eps_), statistics);
}

void Eigensolver::collect_pairs() {
  PetscInt wanted = 0, found = 0;
  check(EPSGetDimensions(eps_, &wanted, nullptr, nullptr));
  check(EPSGetConverged(eps_, &found));
  if (found < wanted) {
    throw NotReached(fmt::format("the eigensolver -{} found {} of {} eigenvalues; raise "
                                 "-{}eps_max_it or -{}eps_ncv",
                                 prefix_, found, wanted, prefix_, prefix_));
  }
  for (PetscInt n = 0; n < found; ++n) {
    Eigenpair pair;
    PetscScalar re = 0, im = 0;
    check(MatCreateVecs(matrix_, pair.real.out(), nullptr));
    check(MatCreateVecs(matrix_, pair.imaginary.out(), nullptr));
    check(EPSGetEigenpair(eps_, n, &re, &im, pair.real, pair.imaginary));
    pair.value = {PetscRealPart(re), kComplex ? PetscImaginaryPart(re) : PetscRealPart(im)};
    PetscReal residual = 0;
    check(EPSComputeError(eps_, n, EPS_ERROR_ABSOLUTE, &residual));
    pair.residual = residual;
    pairs_.push_back(std::move(pair));
  }
}

void Eigensolver::iterate(Vec x) {
  VecHandle y;
  check(VecDuplicate(x, y.out()));
  check(KSPSolve(solver_of(eps_), x, y));
  check(VecCopy(y, x));
}

void probe_eigensolver(const std::string& prefix) {
  constexpr PetscInt size = 100;
  MatHandle diagonal;
  check(MatCreateAIJ(PETSC_COMM_SELF, size, size, size, size, 1, nullptr, 0, nullptr,
                     diagonal.out()));
  for (PetscInt n = 0; n < size; ++n) {
    check(MatSetValue(diagonal, n, n, static_cast<PetscScalar>(n + 1), INSERT_VALUES));
  }
  check(MatAssemblyBegin(diagonal, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(diagonal, MAT_FINAL_ASSEMBLY));
  const EpsHandle eps = configured_eigensolver(diagonal, prefix, -0.5, 1);
  check(EPSSetUp(eps));
}

}  // namespace stickslip::petsc
