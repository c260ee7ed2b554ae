#pragma once
/// KSPs with the defaults of this program, and what they tell about themselves.

#include <petscksp.h>

#include <string>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/petsc/preconditioner.hpp"
#include "stickslip/petsc/solver_choice.hpp"

namespace stickslip::petsc {

/// Makes a KSP a direct solver, preonly around an LU factorisation by MUMPS; to be called before
/// its options are read.
void set_direct_solver(KSP ksp);

/// The ordering AMF where MUMPS is used and the options say nothing else; to be called after.
void set_default_ordering(KSP ksp);

/// Throws NoMemory or NotReached when the factorisation of a KSP has failed.
void require_factored(KSP ksp, const std::string& prefix);

/// Memory and entries of the factors of a KSP, as MUMPS counts them; nothing for other solvers.
void record_factors(KSP ksp, Ledger& ledger);

/// KSP of type preonly around the preconditioner "elements", or else around an LU factorisation by
/// MUMPS with the ordering AMF (MUMPS would choose PORD, as METIS is not in Debian's build, which
/// costs 10 to 30 times more on these matrices). Every choice is a PETSc option under the prefix,
/// e.g. -slide_pc_type lu or -slide_pc_factor_mat_solver_type klu; with any of them LU is the
/// default. Collective.
[[nodiscard]] KspHandle linear_solver(Mat matrix, const std::string& prefix, Solver preferred);

/// Which of them a KSP is.
[[nodiscard]] Solver kind_of(KSP ksp);

/// Makes "elements" call this, which must outlive the solves. Not collective.
void attach(KSP ksp, const Preconditioner& preconditioner);

/// Whether MUMPS ran out of the workspace that it set aside (INFOG(1) = -8, -9): pivots against the
/// order that the analysis foresaw can need more.
[[nodiscard]] bool lacks_workspace(KSP ksp);
/// The same solver set up anew, with twice the workspace at least. Collective.
[[nodiscard]] KspHandle with_more_workspace(KSP ksp, Mat matrix, const std::string& prefix);

/// Orders and analyses `matrix` as MUMPS would, and stops there; zeros for other solvers.
/// Collective.
[[nodiscard]] Analysis analyse(KSP ksp, Mat matrix);

}  // namespace stickslip::petsc
