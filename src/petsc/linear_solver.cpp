#include "stickslip/petsc/linear_solver.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/memory.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

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

bool lacks_workspace(KSP ksp) {
  if (failure_of(ksp) == PC_NOERROR || !uses_mumps(ksp)) return false;
  MatFactorType type = MAT_FACTOR_NONE;
  check(MatGetFactorType(factor_of(ksp), &type));
  const PetscInt info = infog(ksp, 1);
  return type == MAT_FACTOR_LU && (info == -8 || info == -9);
}

// MUMPS adds ICNTL(14) per cent to the workspace that its analysis foresees. PETSc does not let it
// continue after an error, so it begins anew.
KspHandle with_more_workspace(KSP ksp, Mat matrix, const std::string& prefix) {
  constexpr PetscInt least = 100;
  PetscInt percent = 0;
  check(MatMumpsGetIcntl(factor_of(ksp), 14, &percent));
  const OptionFor more(prefix + "mat_mumps_icntl_14", std::to_string(std::max(least, 2 * percent)));
  KspHandle again = linear_solver(matrix, prefix, PCLU);
  check(KSPSetUp(again));
  return again;
}

// MUMPS counts in millions, negative, what exceeds its integers.
double entries_counted(PetscInt entries) {
  return entries < 0 ? -1e6 * static_cast<double>(entries) : static_cast<double>(entries);
}

// By the number of its counters for entries and megabytes.
Analysis counted_by_mumps(KSP ksp, PetscInt entries, PetscInt megabytes) {
  PetscReal operations = 0;
  check(MatMumpsGetRinfog(factor_of(ksp), 1, &operations));
  return {PCLU, entries_counted(infog(ksp, entries)), static_cast<double>(infog(ksp, megabytes)),
          operations};
}

template <class Function>
Function* own_function(KSP ksp, const char* name) {
  Function* function = nullptr;
  const auto pc = reinterpret_cast<PetscObject>(preconditioner_of(ksp));
  check(PetscObjectQueryFunction(pc, name, &function));
  return function;
}

Analyse* analysis_of(KSP ksp) { return own_function<Analyse>(ksp, kAnalyse); }

// Of PCs of this program; no sizes of others.
Analysis own_analysis(KSP ksp) {
  Analysis analysis;
  if (Analyse* const analyse = analysis_of(ksp)) check(analyse(preconditioner_of(ksp), &analysis));
  return analysis;
}

}  // namespace

std::string implied_pc_type(const std::string& prefix) {
  const std::string pc = prefix + "pc_", own = pc + kElementsPc, mat = prefix + "mat_";
  bool others = false;
  for (const auto& name : given_options()) {
    if (name.starts_with(own)) return kElementsPc;
    others = others || name.starts_with(pc) || (name.starts_with(mat) && name != mat + "view");
  }
  return others ? PCLU : "";
}

void set_direct_solver(KSP ksp) {
  check(KSPSetType(ksp, KSPPREONLY));
  PC pc = preconditioner_of(ksp);
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

std::unique_ptr<OptionFor> default_ordering(const std::string& prefix) {
  constexpr const char* amf = "2";
  const std::string name = prefix + "mat_mumps_icntl_7";
  return option_value(name) ? nullptr : std::make_unique<OptionFor>(name, amf);
}

KspHandle linear_solver(Mat matrix, const std::string& prefix, PCType pc_type) {
  KspHandle ksp;
  check(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), ksp.out()));
  check(KSPSetOptionsPrefix(ksp, prefix.c_str()));
  check(KSPSetOperators(ksp, matrix, matrix));
  set_direct_solver(ksp);
  const std::string implied = implied_pc_type(prefix);
  check(PCSetType(preconditioner_of(ksp), implied.empty() ? pc_type : implied.c_str()));
  check(KSPSetFromOptions(ksp));
  return ksp;
}

bool is_own(KSP ksp) { return analysis_of(ksp) != nullptr; }

bool solve_together(KSP ksp, std::span<const Vec> b, std::span<const Vec> x, bool transposed) {
  PetscBool alone = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp), KSPPREONLY, &alone));
  auto* const apply = own_function<ApplyToColumns>(ksp, kApplyToColumns);
  if (alone == PETSC_FALSE || apply == nullptr) return false;
  check(apply(preconditioner_of(ksp), b, x, transposed));
  check(KSPViewFromOptions(ksp, nullptr, "-ksp_view"));  // as KSPSolve does
  return true;
}

void factor(KspHandle& ksp, Mat matrix, const std::string& prefix) {
  const auto amf = default_ordering(prefix);
  const auto owner = reinterpret_cast<PetscObject>(static_cast<KSP>(ksp));
  check(PetscObjectViewFromOptions(reinterpret_cast<PetscObject>(matrix), owner, "-mat_view"));
  check(KSPSetUp(ksp));
  if (lacks_workspace(ksp)) ksp = with_more_workspace(ksp, matrix, prefix);
  require_factored(ksp, prefix);
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

void record_factors(KSP ksp, SolverStatistics& statistics) {
  constexpr PetscInt entries = 29, megabytes = 22;  // of all ranks
  const Analysis sizes =
      uses_mumps(ksp) ? counted_by_mumps(ksp, entries, megabytes) : own_analysis(ksp);
  SolverStatistics seen;
  seen.factor_entries = static_cast<std::int64_t>(sizes.factor_entries);
  seen.factor_megabytes = sizes.megabytes;
  statistics += seen;
}

Analysis analyse(KSP ksp, Mat matrix, const std::string& prefix) {
  if (!uses_mumps(ksp)) return own_analysis(ksp);
  const auto amf = default_ordering(prefix);
  check(PCFactorSetUpMatSolverType(preconditioner_of(ksp)));
  MatFactorInfo info{};
  check(MatFactorInfoInitialize(&info));
  check(MatLUFactorSymbolic(factor_of(ksp), matrix, nullptr, nullptr, &info));
  constexpr PetscInt entries = 3, megabytes = 17;
  return counted_by_mumps(ksp, entries, megabytes);
}

}  // namespace stickslip::petsc
