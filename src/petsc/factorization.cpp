#include "stickslip/petsc/factorization.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr double kBackwardErrorLimit = 1e-12;
constexpr int kMostCorrections = 2;  // the second only where the first leaves too much
// Of the largest component of a plain solution: smaller ones need not be right relative to their
// own size. Where an element is thin or a transform has decayed they are tens of orders smaller,
// and the factors mix their rows with others; what that does to a functional, the last correction
// tells.
constexpr double kNegligible = 1e-13;
constexpr bool kComplex = PetscDefined(USE_COMPLEX);

constexpr const char* kLevels = "levels";

// Options that were set here, not by the user.
std::set<std::string>& own_defaults() {
  static std::set<std::string> names;
  return names;
}

// A default that any option of the user overrides.
void set_default(const std::string& option, const char* value) {
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &given));
  if (given == PETSC_TRUE) return;
  check(PetscOptionsSetValue(nullptr, option.c_str(), value));
  check(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &given));  // counts as used
  own_defaults().insert(option);
}

// PETSc's preconditioner of the type "shell" is filled in when its matrix is known.
PetscErrorCode create_levels(PC pc) {
  PetscFunctionBegin;
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetName(pc, kLevels));
  PetscFunctionReturn(0);
}

bool uses_levels(KSP ksp) {
  PC pc = nullptr;
  PetscBool shell = PETSC_FALSE;
  check(KSPGetPC(ksp, &pc));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &shell));
  return shell == PETSC_TRUE;
}

PetscErrorCode apply_levels(PC pc, Vec b, Vec x) {
  PetscFunctionBegin;
  void* levels = nullptr;
  PetscCall(PCShellGetContext(pc, &levels));
  static_cast<LevelElimination*>(levels)->solve(b, x, false);
  PetscFunctionReturn(0);
}

PetscErrorCode apply_levels_transposed(PC pc, Vec b, Vec x) {
  PetscFunctionBegin;
  void* levels = nullptr;
  PetscCall(PCShellGetContext(pc, &levels));
  static_cast<LevelElimination*>(levels)->solve(b, x, true);
  PetscFunctionReturn(0);
}

std::unique_ptr<LevelElimination> attached_levels(KSP ksp, Mat matrix, Chain chain) {
  auto levels = std::make_unique<LevelElimination>(matrix, std::move(chain));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  check(PCShellSetContext(pc, levels.get()));
  check(PCShellSetApply(pc, apply_levels));
  check(PCShellSetApplyTranspose(pc, apply_levels_transposed));
  return levels;
}

bool uses_mumps(KSP ksp) {
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  MatSolverType type = nullptr;
  check(PCFactorGetMatSolverType(pc, &type));
  return type != nullptr && std::strcmp(type, MATSOLVERMUMPS) == 0;
}

KspHandle configured_solver(Mat matrix, const std::string& prefix, bool narrow_chain) {
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(matrix));
  KspHandle ksp;
  check(KSPCreate(comm, ksp.out()));
  check(KSPSetOptionsPrefix(ksp, prefix.c_str()));
  check(KSPSetOperators(ksp, matrix, matrix));
  set_direct_solver(ksp);
  check(PCRegister(kLevels, create_levels));
  if (narrow_chain && !chooses_solver(prefix)) {
    PC pc = nullptr;
    check(KSPGetPC(ksp, &pc));
    check(PCSetType(pc, kLevels));
  }
  check(KSPSetFromOptions(ksp));
  set_default_ordering(ksp);
  return ksp;
}

Mat factor_of(KSP ksp) {
  PC pc = nullptr;
  Mat factor = nullptr;
  check(KSPGetPC(ksp, &pc));
  check(PCFactorGetMatrix(pc, &factor));
  return factor;
}

PetscInt infog(KSP ksp, PetscInt number) {
  PetscInt value = 0;
  check(MatMumpsGetInfog(factor_of(ksp), number, &value));
  return value;
}

// Of the codes of MUMPS that occur in practice.
std::string meaning_of(PetscInt info) {
  switch (info) {
  case -8:
  case -9: return "its workspace was too small, also when it was enlarged (ICNTL(14))";
  case -10: return "the matrix is singular";
  case -13: return "the system gave it no more memory";
  case -19: return "the workspace allowed by ICNTL(23) is too small; allow more, or leave it out";
  case -90: return "it could not write its factors to disk (MUMPS_OOC_TMPDIR)";
  default: return "see INFOG(1) in its users' guide";
  }
}

std::string describe_failure(KSP ksp) {
  if (!uses_mumps(ksp)) return "no factors, as the matrix may be singular";
  const PetscInt info1 = infog(ksp, 1), info2 = infog(ksp, 2);
  return fmt::format("MUMPS stopped with INFOG(1) = {}, INFOG(2) = {}: {}", info1, info2,
                     meaning_of(info1));
}

// Pivots against the order that the analysis foresaw can need more workspace than it set aside.
bool lacks_workspace(KSP ksp) {
  PC pc = nullptr;
  PCFailedReason reason = PC_NOERROR;
  check(KSPGetPC(ksp, &pc));
  check(PCGetFailedReason(pc, &reason));
  if (reason == PC_NOERROR || !uses_mumps(ksp)) return false;
  MatFactorType type = MAT_FACTOR_NONE;
  check(MatGetFactorType(factor_of(ksp), &type));
  const PetscInt info = infog(ksp, 1);
  return type == MAT_FACTOR_LU && (info == -8 || info == -9);
}

/// A PETSc option for the life of the object; it had a value before, or none.
class OptionFor {
 public:
  OptionFor(std::string name, const std::string& value) : name_(std::move(name)) {
    check(PetscOptionsGetString(nullptr, nullptr, name_.c_str(), before_.data(), before_.size(),
                                &given_));
    check(PetscOptionsSetValue(nullptr, name_.c_str(), value.c_str()));
  }
  ~OptionFor() {
    (void)(given_ == PETSC_TRUE ? PetscOptionsSetValue(nullptr, name_.c_str(), before_.data())
                                : PetscOptionsClearValue(nullptr, name_.c_str()));
  }
  OptionFor(const OptionFor&) = delete;
  OptionFor& operator=(const OptionFor&) = delete;

 private:
  std::string name_;
  std::array<char, 64> before_{};
  PetscBool given_ = PETSC_FALSE;
};

void require_chain(const std::optional<Chain>& chain, const std::string& prefix) {
  if (chain) return;
  throw BadInput(fmt::format("-{}pc_type {}: the unknowns of this solver form no chain of levels; "
                             "leave it out",
                             prefix, kLevels));
}

// MUMPS counts in millions, negative, what exceeds its integers.
double entries_counted(PetscInt entries) {
  return entries < 0 ? -1e6 * static_cast<double>(entries) : static_cast<double>(entries);
}

void take_magnitudes_of_block(Mat block) {
  MatInfo info{};
  check(MatGetInfo(block, MAT_LOCAL, &info));
  PetscScalar* values = nullptr;
  check(MatSeqAIJGetArray(block, &values));
  const auto count = static_cast<std::ptrdiff_t>(info.nz_used);
  std::transform(values, values + count, values, [](PetscScalar a) { return PetscAbsScalar(a); });
  check(MatSeqAIJRestoreArray(block, &values));
}

MatHandle magnitudes(Mat matrix) {
  MatHandle copy;
  check(MatDuplicate(matrix, MAT_COPY_VALUES, copy.out()));
  PetscBool sequential = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATSEQAIJ, &sequential));
  if (sequential == PETSC_TRUE) {
    take_magnitudes_of_block(copy);
  } else {
    Mat diagonal = nullptr, off_diagonal = nullptr;
    check(MatMPIAIJGetSeqAIJ(copy, &diagonal, &off_diagonal, nullptr));
    take_magnitudes_of_block(diagonal);
    take_magnitudes_of_block(off_diagonal);
  }
  return copy;
}

VecHandle magnitude_sums(Mat matrix) {
  VecHandle sums;
  check(MatCreateVecs(matrix, nullptr, sums.out()));
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &begin, &end));
  WriteView local(sums);
  for (PetscInt r = begin; r < end; ++r) {
    PetscInt count = 0;
    const PetscScalar* values = nullptr;
    check(MatGetRow(matrix, r, &count, nullptr, &values));
    local[r - begin] =
        std::accumulate(values, values + count, 0.0,
                        [](double sum, PetscScalar value) { return sum + PetscAbsScalar(value); });
    check(MatRestoreRow(matrix, r, &count, nullptr, &values));
  }
  return sums;
}

VecHandle absolute(Vec x) {
  VecHandle size;
  check(VecDuplicate(x, size.out()));
  check(VecCopy(x, size));
  check(VecAbs(size));
  return size;
}

}  // namespace

bool chooses_solver(const std::string& prefix) {
  char* text = nullptr;
  check(PetscOptionsGetAll(nullptr, &text));
  std::istringstream words(text);
  check(PetscFree(text));
  for (std::string word; words >> word;) {
    const bool chooses =
        word.starts_with("-" + prefix + "pc_") || word.starts_with("-" + prefix + "mat_");
    if (chooses && !own_defaults().contains(word)) return true;
  }
  return false;
}

void set_direct_solver(KSP ksp) {
  check(KSPSetType(ksp, KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

void set_default_ordering(KSP ksp) {
  const char* prefix = nullptr;
  check(KSPGetOptionsPrefix(ksp, &prefix));
  if (uses_mumps(ksp)) set_default(fmt::format("-{}mat_mumps_icntl_7", prefix), "2");  // AMF
}

void require_factored(KSP ksp, const std::string& prefix) {
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  PCFailedReason reason = PC_NOERROR;
  check(PCGetFailedReason(pc, &reason));
  if (reason == PC_NOERROR) return;
  const std::string what = describe_failure(ksp);
  if (reason == PC_FACTOR_OUTMEMORY) {
    throw NoMemory(what + "; the factors need more memory than there is; use a larger -delta, a "
                          "looser -accuracy or more ranks");
  }
  throw NotReached(fmt::format("the solver -{} failed: {}", prefix, what));
}

void record_factors(KSP ksp, Ledger& ledger) {
  if (!uses_mumps(ksp)) return;
  const PetscInt entries = infog(ksp, 29), megabytes = infog(ksp, 22);  // of all ranks
  Ledger size;
  size.factor_entries = static_cast<std::int64_t>(entries_counted(entries));
  size.factor_megabytes = static_cast<double>(megabytes);
  ledger += size;
}

Factorization::Factorization(Mat matrix, const std::string& prefix, Ledger& ledger,
                             std::optional<Chain> chain)
    : prefix_(prefix), ledger_(ledger) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  ksp_ = configured_solver(matrix, prefix, chain && chain->narrow);
  if (uses_levels(ksp_)) {
    require_chain(chain, prefix);
    const PhaseTimer timer("analysis", ledger_.analysis_seconds);
    levels_ = attached_levels(ksp_, matrix, std::move(*chain));
  }
  factor();
}

void Factorization::update() {
  check(KSPSetOperators(ksp_, matrix_, matrix_));
  factor();
}

// MUMPS adds ICNTL(14) per cent to the workspace that its analysis foresees. PETSc does not let it
// go on after an error, so it begins anew.
void Factorization::factor_with_more_workspace() {
  constexpr PetscInt least = 100;
  PetscInt percent = 0;
  check(MatMumpsGetIcntl(factor_of(ksp_), 14, &percent));
  const OptionFor more(fmt::format("-{}mat_mumps_icntl_14", prefix_),
                       std::to_string(std::max(least, 2 * percent)));
  ksp_ = configured_solver(matrix_, prefix_, false);
  check(KSPSetUp(ksp_));
}

void Factorization::factor() {
  magnitude_ = {};
  magnitude_sums_ = {};
  if (levels_) {
    const PhaseTimer timer("factorisation", ledger_.factorization_seconds);
    levels_->factor();
    Ledger size;
    size.factor_entries = static_cast<std::int64_t>(levels_->entries());
    size.factor_megabytes = levels_->bytes() / 1e6;
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
    if (lacks_workspace(ksp_)) factor_with_more_workspace();
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
    throw NotReached(
        fmt::format("the solver -{} stopped: {}", prefix_, KSPConvergedReasons[reason]));
  }
}

// The rows of A differ by many orders of magnitude, so that norms of the whole matrix would hide a
// bad row; |A| |x| does not. A plain solution is of one size: the largest component counts (Oettli
// and Prager). A transposed one is an occupation, time spent in each state: |A|^T |x| counts
// visits, falls off by tens of orders of magnitude, and its sum is what functionals see.
double Factorization::backward_error(Vec residual, Vec b, Vec x) {
  if (magnitude_ == nullptr) magnitude_ = magnitudes(matrix_);
  const VecHandle size = absolute(x), bound = absolute(b);
  PetscReal largest = 0, error = 0;
  check(VecNorm(x, NORM_INFINITY, &largest));
  check(VecShift(size, kNegligible * largest));
  check(MatMultAdd(magnitude_, size, bound, bound));
  check(VecPointwiseDivide(residual, residual, bound));  // 0/0 counts as 0 in PETSc
  check(VecNorm(residual, NORM_INFINITY, &error));
  return error;
}

// The sum of |A|^T |x| takes the sums of the rows of |A| alone.
double Factorization::backward_error_transposed(Vec residual, Vec b, Vec x) {
  if (magnitude_sums_ == nullptr) magnitude_sums_ = magnitude_sums(matrix_);
  const VecHandle size = absolute(x);
  PetscScalar visits = 0;
  PetscReal error = 0, b_size = 0;
  check(VecTDot(magnitude_sums_, size, &visits));
  check(VecNorm(b, NORM_1, &b_size));
  check(VecNorm(residual, NORM_1, &error));
  return error / (PetscRealPart(visits) + b_size);
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
        transposed ? backward_error_transposed(residual, b, s.x) : backward_error(residual, b, s.x);
    sound = s.backward_error <= kBackwardErrorLimit;
    ++ledger_.corrections;
  }
  Ledger seen;
  seen.backward_error = s.backward_error;
  ledger_ += seen;
  if (!sound) {
    throw NotReached(fmt::format("the solver -{} left a backward error of {:.1e} (limit {:.0e})",
                                 prefix_, s.backward_error, kBackwardErrorLimit));
  }
  return s;
}

Analysis Factorization::analyse(Mat matrix, const std::string& prefix, Ledger& ledger,
                                std::optional<Chain> chain) {
  const PhaseTimer timer("analysis", ledger.analysis_seconds);
  const KspHandle ksp = configured_solver(matrix, prefix, chain && chain->narrow);
  if (uses_levels(ksp)) {
    require_chain(chain, prefix);
    const LevelElimination levels(matrix, std::move(*chain));
    return {true, levels.entries(), levels.bytes() / 1e6, levels.operations()};
  }
  if (!uses_mumps(ksp)) return {};
  PC pc = nullptr;
  Mat factor = nullptr;
  check(KSPGetPC(ksp, &pc));
  check(PCFactorSetUpMatSolverType(pc));
  check(PCFactorGetMatrix(pc, &factor));
  MatFactorInfo info{};
  check(MatFactorInfoInitialize(&info));
  check(MatLUFactorSymbolic(factor, matrix, nullptr, nullptr, &info));
  PetscInt entries = 0, megabytes = 0;
  PetscReal operations = 0;
  check(MatMumpsGetInfog(factor, 3, &entries));
  check(MatMumpsGetInfog(factor, 17, &megabytes));
  check(MatMumpsGetRinfog(factor, 1, &operations));
  return {false, entries_counted(entries), static_cast<double>(megabytes), operations};
}

void Factorization::probe_options(const std::string& prefix) {
  MatHandle unit;
  check(MatCreate(PETSC_COMM_SELF, unit.out()));
  check(MatSetSizes(unit, 2, 2, 2, 2));
  check(MatSetType(unit, MATAIJ));
  check(MatSetUp(unit));
  for (PetscInt i = 0; i < 2; ++i) check(MatSetValue(unit, i, i, 1, INSERT_VALUES));
  check(MatAssemblyBegin(unit, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(unit, MAT_FINAL_ASSEMBLY));
  const KspHandle ksp = configured_solver(unit, prefix, false);
  check(KSPSetUp(ksp));
}

}  // namespace stickslip::petsc
