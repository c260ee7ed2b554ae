#include "stickslip/linalg/eigensolver.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "stickslip/linalg/solver.hpp"
#include "stickslip/linalg/solver_options.hpp"

namespace stickslip::linalg {
namespace {

constexpr double kTolerance = 1e-13;

KSP solver_of(EPS eps) {
  ST st = nullptr;
  check(EPSGetST(eps, &st));
  KSP ksp = nullptr;
  check(STGetKSP(st, &ksp));
  return ksp;
}

// Each vector costs a solve. One eigenvalue next to the target comes with the first few. Several
// take most of a space, which is looked at when it is full: one that keeps most vectors where it is
// restarted takes a quarter less of them than SLEPc's own choice. How many are wanted, and in which
// space, the user may have changed.
void choose_space(EPS eps) {
  constexpr PetscInt for_one = 4, besides = 24;
  PetscInt wanted = 0, space = 0, projected = 0;
  check(EPSGetDimensions(eps, &wanted, &space, &projected));
  const bool open = space < 0 && projected < 0;  // by a constant of PETSc, another from 3.22 on
  if (!open) return;
  check(EPSSetDimensions(eps, wanted, wanted == 1 ? for_one : wanted + besides, PETSC_DEFAULT));
}

// SLEPc's own would be a copy that knows nothing of what the matrix carries.
void set_shifted(EPS eps, const ShiftedSolver& shifted) {
  if (!shifted.matrix) return;
  ST st = nullptr;
  check(EPSGetST(eps, &st));
  PetscScalar target = 0;
  check(STGetShift(st, &target));  // 0 unless given
  if (target == 0.0) check(EPSGetTarget(eps, &target));
  const MatHandle matrix = shifted.matrix(target);
  check(STSetPreconditionerMat(st, matrix));
}

EpsHandle configured_eigensolver(Mat matrix, const std::string& prefix, double target, int wanted,
                                 const ShiftedSolver& shifted = {}) {
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
  const std::string implied = implied_pc_type(prefix + "st_");
  PC pc = nullptr;
  check(KSPGetPC(solver_of(eps), &pc));
  check(PCSetType(pc, implied.empty() ? shifted.pc_type : implied.c_str()));
  if (shifted.matrix) check(STSetMatMode(st, ST_MATMODE_SHELL));
  // Each rank would solve the small projected problem by itself, to other last bits where its
  // memory lies otherwise, and one that finds it converged would leave the others waiting.
  DS projected = nullptr;
  check(EPSGetDS(eps, &projected));
  check(DSSetParallel(projected, DS_PARALLEL_SYNCHRONIZED));
  check(EPSSetType(eps, EPSKRYLOVSCHUR));
  constexpr double kept_at_restart = 0.85;
  if (wanted > 1) check(EPSKrylovSchurSetRestart(eps, kept_at_restart));
  check(EPSSetFromOptions(eps));
  choose_space(eps);
  set_shifted(eps, shifted);
  return eps;
}

bool are_conjugate(std::complex<double> a, std::complex<double> b) {
  return std::abs(a - std::conj(b)) < 1e-6 * std::abs(a);
}

}  // namespace

Eigensolver::Eigensolver(Mat matrix, const std::string& prefix, double target, int wanted,
                         SolverStatistics& statistics, const ShiftedSolver& shifted)
    : matrix_(matrix), prefix_(prefix) {
  double total = 0, symbolic = 0, set_up = 0;
  {
    const PhaseTimer timer("eigenvalues", total);
    const EventTimer analysis("MatLUFactorSym");
    const double start = wall_seconds();
    eps_ = configured_eigensolver(matrix, prefix, target, wanted, shifted);
    const auto amf = default_ordering(prefix + "st_");
    check(EPSSetUp(eps_));
    require_factored(solver_of(eps_), prefix + "st_");
    set_up = wall_seconds() - start;
    check(EPSSolve(eps_));
    collect_pairs();
    symbolic = analysis.seconds();
  }
  statistics.analysis_seconds += symbolic;
  statistics.factorization_seconds += set_up - symbolic;
  statistics.solve_seconds += total - set_up;
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
  for (PetscInt n = 0; n < std::min(found, wanted + 1); ++n) {
    Eigenpair pair;
    PetscScalar re = 0, im = 0;
    check(MatCreateVecs(matrix_, pair.real.out(), nullptr));
    check(MatCreateVecs(matrix_, pair.imaginary.out(), nullptr));
    check(EPSGetEigenpair(eps_, n, &re, &im, pair.real, pair.imaginary));
    pair.value = {PetscRealPart(re), kComplex ? PetscImaginaryPart(re) : PetscRealPart(im)};
    if (n == wanted && !are_conjugate(pair.value, pairs_.back().value)) break;
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
  for (PetscInt n = 0; n < size; ++n) {  // no eigenvalue that a user may name as a target
    check(MatSetValue(diagonal, n, n, static_cast<PetscScalar>(n + M_SQRT2), INSERT_VALUES));
  }
  check(MatAssemblyBegin(diagonal, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(diagonal, MAT_FINAL_ASSEMBLY));
  const EpsHandle eps = configured_eigensolver(diagonal, prefix, -0.5, 1);
  check(EPSSetUp(eps));
}

}  // namespace stickslip::linalg
