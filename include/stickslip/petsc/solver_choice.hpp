#pragma once
/// Which solver the options choose, and what its analysis predicts: plain data for plans.

#include <string>

namespace stickslip::petsc {

/// The PC type of this program, which the operators register.
inline constexpr const char* kElementsPc = "elements";

/// What options under the prefix choose of the preconditioner and its matrices, if anything: the
/// default of -<prefix>pc_type is "elements" where its own options are given, and "lu" with others.
[[nodiscard]] std::string implied_pc_type(const std::string& prefix);

/// What an analysis predicts; zeros for solvers that report nothing.
struct Analysis {
  std::string pc_type;
  double factor_entries = 0;
  double megabytes = 0;   ///< of all ranks, while factoring
  double operations = 0;  ///< of factoring
};

/// Prints PETSc's help of a KSP with that prefix, around the PC "elements" unless options choose
/// another, to standard output. Collective on PETSC_COMM_SELF.
void print_linear_solver_options(const std::string& prefix);

/// Each reads all options of a role once, on a small matrix, so that unknown ones can be reported
/// before any work. Collective on PETSC_COMM_SELF only.
void probe_linear_solver(const std::string& prefix);
void probe_eigensolver(const std::string& prefix);

}  // namespace stickslip::petsc
