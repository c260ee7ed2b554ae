#pragma once
/// KSPs that are direct solvers, and what they tell about themselves.

#include <petscksp.h>

#include <memory>
#include <optional>
#include <string>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/petsc/level_elimination.hpp"

namespace stickslip::petsc {

/// Whether options under the prefix say something about the preconditioner or its matrices.
[[nodiscard]] bool chooses_solver(const std::string& prefix);

/// Makes a KSP a direct solver, preonly around an LU factorisation by MUMPS; to be called before
/// its options are read.
void set_direct_solver(KSP ksp);

/// The ordering AMF where MUMPS is used and the options say nothing else; to be called after.
void set_default_ordering(KSP ksp);

/// Throws NoMemory or NotReached when the factorisation of a KSP has failed.
void require_factored(KSP ksp, const std::string& prefix);

/// Memory and entries of the factors of a KSP, as MUMPS counts them; nothing for other solvers.
void record_factors(KSP ksp, Ledger& ledger);

/// KSP of type preonly around a direct solver: for a narrow chain of blocks the preconditioner
/// "levels", which is LevelElimination, and else an LU factorisation by MUMPS with the ordering
/// AMF (MUMPS would choose PORD, as METIS is not in Debian's build, which costs 10 to 30 times more
/// on these matrices). Every choice is a PETSc option under the prefix, e.g. -slide_pc_type lu or
/// -slide_pc_factor_mat_solver_type klu; with any of them LU is the default. Collective.
[[nodiscard]] KspHandle direct_solver(Mat matrix, const std::string& prefix, bool narrow_chain);

/// Whether the preconditioner is "levels".
[[nodiscard]] bool uses_levels(KSP ksp);

/// Makes "levels" an elimination of `matrix`, which must outlive the solves. Collective. Throws
/// BadInput without a chain.
[[nodiscard]] std::unique_ptr<LevelElimination> attach_levels(KSP ksp, Mat matrix,
                                                              std::optional<Chain> chain);

/// Whether MUMPS ran out of the workspace that it set aside (INFOG(1) = -8, -9): pivots against the
/// order that the analysis foresaw can need more.
[[nodiscard]] bool lacks_workspace(KSP ksp);
/// The same solver set up anew, with twice the workspace at least. Collective.
[[nodiscard]] KspHandle with_more_workspace(KSP ksp, Mat matrix, const std::string& prefix);

/// What the analysis of an elimination by levels or by MUMPS foretells; zeros for other solvers.
struct Analysis {
  bool by_levels = false;
  double factor_entries = 0;
  double megabytes = 0;   ///< of all ranks, while factoring
  double operations = 0;  ///< of the elimination
};

/// Orders and analyses `matrix` as factoring would, and stops there. Collective.
[[nodiscard]] Analysis analyse(KSP ksp, Mat matrix, std::optional<Chain> chain);

}  // namespace stickslip::petsc
