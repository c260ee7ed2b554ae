#pragma once
/// KSPs with the defaults of this program, and what they tell about themselves.

#include <petscksp.h>

#include <string>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/petsc/preconditioner.hpp"

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

/// By what a system is solved.
enum class Solver {
  lu,          ///< any of PETSc's preconditioners; by default an LU factorisation by MUMPS
  levels,      ///< LevelElimination
  p_multigrid  ///< GMRES with PMultigrid
};

/// What the options under the prefix choose, and `preferred` where they say nothing. Local.
[[nodiscard]] Solver chosen_solver(const std::string& prefix, Solver preferred);

/// KSP for one of these: of type preonly around the preconditioner "levels"; of type gmres around
/// "p_multigrid"; else preonly around an LU factorisation by MUMPS with the ordering AMF (MUMPS
/// would choose PORD, as METIS is not in Debian's build, which costs 10 to 30 times more on these
/// matrices). Every choice is a PETSc option under the prefix, e.g. -slide_pc_type lu or
/// -slide_pc_factor_mat_solver_type klu; with any of them LU is the default. Collective.
[[nodiscard]] KspHandle linear_solver(Mat matrix, const std::string& prefix, Solver preferred);

/// Which of them a KSP is.
[[nodiscard]] Solver kind_of(KSP ksp);

/// Makes "levels" or "p_multigrid" call this, which must outlive the solves. Not collective.
void attach(KSP ksp, const Preconditioner& preconditioner);

/// Whether MUMPS ran out of the workspace that it set aside (INFOG(1) = -8, -9): pivots against the
/// order that the analysis foresaw can need more.
[[nodiscard]] bool lacks_workspace(KSP ksp);
/// The same solver set up anew, with twice the workspace at least. Collective.
[[nodiscard]] KspHandle with_more_workspace(KSP ksp, Mat matrix, const std::string& prefix);

/// What an analysis foretells; zeros for solvers that tell nothing.
struct Analysis {
  Solver solver = Solver::lu;
  double factor_entries = 0;
  double megabytes = 0;   ///< of all ranks, while factoring
  double operations = 0;  ///< of factoring
};

/// Orders and analyses `matrix` as MUMPS would, and stops there; zeros for other solvers.
/// Collective.
[[nodiscard]] Analysis analyse(KSP ksp, Mat matrix);

}  // namespace stickslip::petsc
