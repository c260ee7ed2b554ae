#include "stickslip/petsc/factorization.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <string>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr double kBackwardErrorLimit = 1e-12;
constexpr int kMostCorrections = 2;  // the second only where the first leaves too much
constexpr bool kComplex = PetscDefined(USE_COMPLEX);

// What the solver of a KSP calls; null for PETSc's own.
std::unique_ptr<Preconditioner> own_preconditioner(KSP ksp, const Structure& structure) {
  if (kind_of(ksp) == Solver::lu) return nullptr;
  if (!structure.elimination) {
    const char* prefix = nullptr;
    check(KSPGetOptionsPrefix(ksp, &prefix));
    throw BadInput(fmt::format("-{}pc_type: this solver eliminates elements of an hp "
                               "discretisation, on one rank; leave it out",
                               prefix));
  }
  auto own = structure.elimination();
  attach(ksp, *own);
  return own;
}

}  // namespace

Factorization::Factorization(Mat matrix, const std::string& prefix, Ledger& ledger,
                             const Structure& structure)
    : measure_(matrix), prefix_(prefix), ledger_(ledger) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  ksp_ = linear_solver(matrix_, prefix_, structure.solver());
  {
    const PhaseTimer timer("analysis", ledger_.analysis_seconds);
    own_ = own_preconditioner(ksp_, structure);
  }
  factor(0);
}

void Factorization::update(PetscScalar shift) {
  check(KSPSetOperators(ksp_, matrix_, matrix_));
  factor(shift);
}

void Factorization::factor(PetscScalar shift) {
  measure_.forget();
  if (own_) {
    const PhaseTimer timer("factorisation", ledger_.factorization_seconds);
    own_->factor(shift);
    Ledger size;
    size.factor_entries = static_cast<std::int64_t>(own_->entries());
    size.factor_megabytes = own_->bytes() / 1e6;
    ledger_ += size;
  } else {
    factor_by_petsc();
  }
  ++(kComplex ? ledger_.factorizations_complex : ledger_.factorizations_real);
}

void Factorization::factor_by_petsc() {
  double total = 0;
  const double symbolic_before = logged_seconds("MatLUFactorSym");
  {
    const PhaseTimer timer("factorisation", total);
    check(KSPSetUp(ksp_));
    if (lacks_workspace(ksp_)) ksp_ = with_more_workspace(ksp_, matrix_, prefix_);
    require_factored(ksp_, prefix_);
  }
  const double symbolic = logged_seconds("MatLUFactorSym") - symbolic_before;
  ledger_.analysis_seconds += symbolic;
  ledger_.factorization_seconds += total - symbolic;
  record_factors(ksp_, ledger_);
}

void Factorization::solve_once(Vec b, Vec x) {
  const PhaseTimer timer("solve", ledger_.solve_seconds);
  apply(b, x, false);
  ++ledger_.solves;
}

void Factorization::solve_transposed_once(Vec b, Vec x) {
  const PhaseTimer timer("solve", ledger_.solve_seconds);
  apply(b, x, true);
  ++ledger_.solves;
}

void Factorization::apply(Vec b, Vec x, bool transposed) {
  check(transposed ? KSPSolveTranspose(ksp_, b, x) : KSPSolve(ksp_, b, x));
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(ksp_, &iterations));
  if (iterations > 1) ledger_.iterations += static_cast<int>(iterations);
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp_, &reason));
  if (reason < 0) {
    throw NotReached(fmt::format("the solver -{} stopped: {}{}", prefix_,
                                 KSPConvergedReasons[reason], advice()));
  }
}

Solution Factorization::solve(Vec b, bool transposed) {
  const PhaseTimer timer("solve", ledger_.solve_seconds);
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
  ++ledger_.solves;
  bool sound = false;
  for (int n = 0; n < kMostCorrections && !sound; ++n) {
    compute_residual();  // again, as backward_error may overwrite it
    apply(residual, step, transposed);
    check(VecAXPY(s.x, 1, step));
    check(VecAXPY(s.correction, 1, step));
    compute_residual();
    s.backward_error =
        transposed ? measure_.transposed(residual, b, s.x) : measure_.plain(residual, b, s.x);
    sound = s.backward_error <= kBackwardErrorLimit;
    ++ledger_.corrections;
  }
  if (!sound) {
    throw NotReached(fmt::format("the solver -{} left a backward error of {:.1e} (limit {:.0e}){}",
                                 prefix_, s.backward_error, kBackwardErrorLimit, advice()));
  }
  Ledger seen;
  seen.backward_error = s.backward_error;
  ledger_ += seen;
  return s;
}

std::string Factorization::advice() const {
  return own_ ? fmt::format("; -{}pc_type lu exchanges more rows", prefix_) : "";
}

Analysis Factorization::analyse(Mat matrix, const std::string& prefix, Ledger& ledger,
                                const Structure& structure) {
  const PhaseTimer timer("analysis", ledger.analysis_seconds);
  const KspHandle ksp = linear_solver(matrix, prefix, structure.solver());
  const auto own = own_preconditioner(ksp, structure);
  if (!own) return petsc::analyse(ksp, matrix);
  return {kind_of(ksp), own->entries(), own->bytes() / 1e6, own->operations()};
}

void probe_linear_solver(const std::string& prefix) {
  MatHandle unit;
  check(MatCreate(PETSC_COMM_SELF, unit.out()));
  check(MatSetSizes(unit, 2, 2, 2, 2));
  check(MatSetType(unit, MATAIJ));
  check(MatSetUp(unit));
  for (PetscInt i = 0; i < 2; ++i) check(MatSetValue(unit, i, i, 1, INSERT_VALUES));
  check(MatAssemblyBegin(unit, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(unit, MAT_FINAL_ASSEMBLY));
  const KspHandle ksp = linear_solver(unit, prefix, Solver::lu);
  check(KSPSetUp(ksp));
}

}  // namespace stickslip::petsc
