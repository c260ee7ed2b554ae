#pragma once
/// KSPs with the defaults of this program, and what they report about themselves.

#include <petscksp.h>

#include <memory>
#include <span>
#include <string>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/solver_choice.hpp"
#include "stickslip/petsc/solver_options.hpp"
#include "stickslip/petsc/solver_statistics.hpp"

namespace stickslip::petsc {

/// Functions composed on a PC of this program: it predicts its cost for the matrix that it has, and
/// is applied to several vectors at once.
using Analyse = PetscErrorCode(PC, Analysis*);
using ApplyToColumns = PetscErrorCode(PC, std::span<const Vec> b, std::span<const Vec> x,
                                      bool transposed);
inline constexpr const char* kAnalyse = "PCAnalyse_C";
inline constexpr const char* kApplyToColumns = "PCApplyToColumns_C";

/// Makes a KSP a direct solver, preonly around an LU factorisation by MUMPS; to be called before
/// its options are read. Not collective.
void set_direct_solver(KSP ksp);

/// The ordering AMF in analyses by MUMPS with this prefix during the life of what it returns,
/// unless -<prefix>mat_mumps_icntl_7 says otherwise: MUMPS would choose PORD, as METIS is not in
/// Debian's build, which costs 10 to 30 times more on these matrices. PETSc takes it from its
/// options alone.
[[nodiscard]] std::unique_ptr<OptionFor> default_ordering(const std::string& prefix);

/// KSP of type preonly around a PC of type `pc_type`; with PCLU around MUMPS. Every choice is a
/// PETSc option under the prefix, e.g. -slide_pc_type lu or -slide_pc_factor_mat_solver_type klu;
/// with any option of the PC or its matrices LU is the default. Collective.
[[nodiscard]] KspHandle linear_solver(Mat matrix, const std::string& prefix, PCType pc_type);

/// Whether the PC of a KSP is of a type of this program: it needs the matrix of an operator.
[[nodiscard]] bool is_own(KSP ksp);

/// Solves for all of `b` at once, or with the transposed matrix, where a KSP is nothing but a PC of
/// this program: others return false. Collective.
[[nodiscard]] bool solve_together(KSP ksp, std::span<const Vec> b, std::span<const Vec> x,
                                  bool transposed);

/// Factors; MUMPS gets more workspace once if it runs out of what it set aside (INFOG(1) = -8, -9),
/// as pivots against the order that the analysis foresaw can need more, for which `ksp` is made
/// anew. Collective. Throws NoMemory or NotReached when the factorisation has failed.
void factor(KspHandle& ksp, Mat matrix, const std::string& prefix);

/// Throws NoMemory or NotReached when the factorisation of a KSP has failed.
void require_factored(KSP ksp, const std::string& prefix);

/// Adds memory and entries of the factors of a KSP, as MUMPS or kAnalyse count them; nothing for
/// other solvers.
void record_factors(KSP ksp, SolverStatistics& statistics);

/// Orders and analyses `matrix` as the PC would, and stops there; zeros for solvers that report
/// nothing. Collective.
[[nodiscard]] Analysis analyse(KSP ksp, Mat matrix, const std::string& prefix);

}  // namespace stickslip::petsc
