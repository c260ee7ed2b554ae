#include "stickslip/petsc/linear_solver.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/memory.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr const char* kElements = "elements";

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

// Called by PETSc.

// PETSc's preconditioner of the type "shell" is filled in when its matrix is known.
PetscErrorCode create_elements(PC pc) {
  const PetscErrorCode code = PCSetType(pc, PCSHELL);
  return code == 0 ? PCShellSetName(pc, kElements) : code;
}

template <bool transposed>
PetscErrorCode apply(PC pc, Vec b, Vec x) {
  return guarded([&] {
    void* own = nullptr;
    check(PCShellGetContext(pc, &own));
    static_cast<const Preconditioner*>(own)->apply(b, x, transposed);
  });
}

PC preconditioner_of(KSP ksp) {
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  return pc;
}

PCFailedReason failure_of(KSP ksp) {
  PCFailedReason reason = PC_NOERROR;
  check(PCGetFailedReason(preconditioner_of(ksp), &reason));
  return reason;
}

bool uses_mumps(KSP ksp) {
  MatSolverType type = nullptr;
  check(PCFactorGetMatSolverType(preconditioner_of(ksp), &type));
  return type != nullptr && std::strcmp(type, MATSOLVERMUMPS) == 0;
}

Mat factor_of(KSP ksp) {
  Mat factor = nullptr;
  check(PCFactorGetMatrix(preconditioner_of(ksp), &factor));
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

// MUMPS counts in millions, negative, what exceeds its integers.
double entries_counted(PetscInt entries) {
  return entries < 0 ? -1e6 * static_cast<double>(entries) : static_cast<double>(entries);
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
  PC pc = preconditioner_of(ksp);
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

void set_default_ordering(KSP ksp) {
  const char* prefix = nullptr;
  check(KSPGetOptionsPrefix(ksp, &prefix));
  if (uses_mumps(ksp)) set_default(fmt::format("-{}mat_mumps_icntl_7", prefix), "2");  // AMF
}

void require_factored(KSP ksp, const std::string& prefix) {
  const PCFailedReason reason = failure_of(ksp);
  if (reason == PC_NOERROR) return;
  const std::string what = describe_failure(ksp);
  if (reason == PC_FACTOR_OUTMEMORY) {
    throw NoMemory(fmt::format("{}; {}", what, kFactorsTooLarge));
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

Solver chosen_solver(const std::string& prefix, Solver preferred) {
  if (!chooses_solver(prefix)) return preferred;
  std::array<char, 64> type{};
  check(PetscOptionsGetString(nullptr, nullptr, fmt::format("-{}pc_type", prefix).c_str(),
                              type.data(), type.size(), nullptr));
  return std::strcmp(type.data(), kElements) == 0 ? Solver::elements : Solver::lu;
}

KspHandle linear_solver(Mat matrix, const std::string& prefix, Solver preferred) {
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(matrix));
  KspHandle ksp;
  check(KSPCreate(comm, ksp.out()));
  check(KSPSetOptionsPrefix(ksp, prefix.c_str()));
  check(KSPSetOperators(ksp, matrix, matrix));
  set_direct_solver(ksp);
  check(PCRegister(kElements, create_elements));
  if (chosen_solver(prefix, preferred) == Solver::elements) {
    check(PCSetType(preconditioner_of(ksp), kElements));
  }
  check(KSPSetFromOptions(ksp));
  set_default_ordering(ksp);
  return ksp;
}

Solver kind_of(KSP ksp) {
  PC pc = preconditioner_of(ksp);
  PetscBool shell = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &shell));
  return shell == PETSC_TRUE ? Solver::elements : Solver::lu;
}

void attach(KSP ksp, const Preconditioner& preconditioner) {
  PC pc = preconditioner_of(ksp);
  // PETSc's interface knows no const.
  check(PCShellSetContext(pc, const_cast<Preconditioner*>(&preconditioner)));
  check(PCShellSetApply(pc, apply<false>));
  check(PCShellSetApplyTranspose(pc, apply<true>));
}

bool lacks_workspace(KSP ksp) {
  if (failure_of(ksp) == PC_NOERROR || !uses_mumps(ksp)) return false;
  MatFactorType type = MAT_FACTOR_NONE;
  check(MatGetFactorType(factor_of(ksp), &type));
  const PetscInt info = infog(ksp, 1);
  return type == MAT_FACTOR_LU && (info == -8 || info == -9);
}

// MUMPS adds ICNTL(14) per cent to the workspace that its analysis foresees. PETSc does not let it
// go on after an error, so it begins anew.
KspHandle with_more_workspace(KSP ksp, Mat matrix, const std::string& prefix) {
  constexpr PetscInt least = 100;
  PetscInt percent = 0;
  check(MatMumpsGetIcntl(factor_of(ksp), 14, &percent));
  const OptionFor more(fmt::format("-{}mat_mumps_icntl_14", prefix),
                       std::to_string(std::max(least, 2 * percent)));
  KspHandle again = linear_solver(matrix, prefix, Solver::lu);
  check(KSPSetUp(again));
  return again;
}

Analysis analyse(KSP ksp, Mat matrix) {
  if (!uses_mumps(ksp)) return {};
  check(PCFactorSetUpMatSolverType(preconditioner_of(ksp)));
  Mat factor = factor_of(ksp);
  MatFactorInfo info{};
  check(MatFactorInfoInitialize(&info));
  check(MatLUFactorSymbolic(factor, matrix, nullptr, nullptr, &info));
  PetscInt entries = 0, megabytes = 0;
  PetscReal operations = 0;
  check(MatMumpsGetInfog(factor, 3, &entries));
  check(MatMumpsGetInfog(factor, 17, &megabytes));
  check(MatMumpsGetRinfog(factor, 1, &operations));
  return {Solver::lu, entries_counted(entries), static_cast<double>(megabytes), operations};
}

}  // namespace stickslip::petsc
