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
std::unique_ptr<Preconditioner> own_preconditioner(KSP ksp, Mat matrix, Structure structure) {
  std::unique_ptr<Preconditioner> own;
  const Solver solver = kind_of(ksp);
  if (solver == Solver::lu) return own;
  const char* prefix = nullptr;
  check(KSPGetOptionsPrefix(ksp, &prefix));
  if (solver == Solver::p_multigrid) {
    own = std::move(structure.multigrid);
  } else if (structure.chain) {
    own = std::make_unique<LevelElimination>(matrix, structure.chain());
  }
  if (!own) {
    throw BadInput(fmt::format("-{}pc_type: this solver has no {}; leave it out", prefix,
                               solver == Solver::levels ? "chain of levels to eliminate"
                                                        : "elements of several degrees"));
  }
  attach(ksp, *own);
  return own;
}

}  // namespace

Solver Structure::preferred() const {
  if (multigrid) return Solver::p_multigrid;
  return chain && narrow ? Solver::levels : Solver::lu;
}

Factorization::Factorization(Mat matrix, const std::string& prefix, Ledger& ledger,
                             Structure structure)
    : measure_(matrix), prefix_(prefix), ledger_(ledger) {
  keep(matrix);
  try {
    use(std::move(structure));
  } catch (const NotReached&) {
    if (!replaceable()) throw;
    eliminate_instead();
  }
}

void Factorization::keep(Mat matrix) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  measure_ = BackwardError(matrix);
}

bool Factorization::replaceable() const {
  return kind_of(ksp_) == Solver::p_multigrid && chain_ && !chooses_solver(prefix_);
}

void Factorization::eliminate_instead() {
  own_.reset();  // its memory first
  if (assembled_) keep(assembled_());
  use({chain_, true});
}

void Factorization::use(Structure structure) {
  chain_ = structure.chain;
  assembled_ = structure.assembled;
  ksp_ = linear_solver(matrix_, prefix_, structure.preferred());
  {
    const PhaseTimer timer("analysis", ledger_.analysis_seconds);
    own_ = own_preconditioner(ksp_, matrix_, std::move(structure));
  }
  factor();
}

void Factorization::update() {
  check(KSPSetOperators(ksp_, matrix_, matrix_));
  factor();
}

void Factorization::factor() {
  measure_.forget();
  if (own_) {
    const PhaseTimer timer("factorisation", ledger_.factorization_seconds);
    own_->factor();
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

bool Factorization::iterates() const {
  PetscBool preconditions_only = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(static_cast<KSP>(ksp_)), KSPPREONLY,
                               &preconditions_only));
  return preconditions_only == PETSC_FALSE;
}

void Factorization::apply(Vec b, Vec x, bool transposed, bool from_guess) {
  check(KSPSetInitialGuessNonzero(ksp_, from_guess ? PETSC_TRUE : PETSC_FALSE));
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

void Factorization::precondition(Vec b, Vec x, bool transposed) {
  if (own_) return own_->apply(b, x, transposed);
  apply(b, x, transposed);
}

Solution Factorization::solve(Vec b, bool transposed, Vec guess) {
  try {
    return solve_by_ksp(b, transposed, guess);
  } catch (const NotReached&) {
    if (!replaceable()) throw;
    eliminate_instead();
    return solve_by_ksp(b, transposed, guess);
  }
}

Solution Factorization::solve_by_ksp(Vec b, bool transposed, Vec guess) {
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
  const bool from_guess = guess != nullptr && iterates();
  if (from_guess) check(VecCopy(guess, s.x));
  apply(b, s.x, transposed, from_guess);
  ++ledger_.solves;
  bool sound = false;
  for (int n = 0; n < kMostCorrections && !sound; ++n) {
    compute_residual();  // again, as backward_error may overwrite it
    precondition(residual, step, transposed);
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
  switch (kind_of(ksp_)) {
  case Solver::levels: return fmt::format("; -{}pc_type lu exchanges more rows", prefix_);
  case Solver::p_multigrid: return fmt::format("; leave -{}pc_type p_multigrid out", prefix_);
  case Solver::lu: break;
  }
  return "";
}

Analysis Factorization::analyse(Mat matrix, const std::string& prefix, Ledger& ledger,
                                Structure structure) {
  const PhaseTimer timer("analysis", ledger.analysis_seconds);
  const KspHandle ksp = linear_solver(matrix, prefix, structure.preferred());
  const auto own = own_preconditioner(ksp, matrix, std::move(structure));
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
  for (Solver solver : {Solver::lu, Solver::p_multigrid}) {
    const KspHandle ksp = linear_solver(unit, prefix, solver);
    check(KSPSetUp(ksp));
  }
}

}  // namespace stickslip::petsc
