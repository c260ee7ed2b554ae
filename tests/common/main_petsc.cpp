/// Starts PETSc around Catch2: the same cases run on every rank, only rank 0 reports unless another
/// rank fails.

#include <mpi.h>

#include <iostream>
#include <sstream>

#include "run_catch.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/session.hpp"

int main(int argc, char** argv) {
  int petsc_argc = 1;  // Catch2's flags are no PETSc options; those come by PETSC_OPTIONS
  const stickslip::linalg::Session session(petsc_argc, argv);
  stickslip::linalg::keep_blas_to_one_thread();
  stickslip::generator::register_preconditioners();
  const int rank = stickslip::linalg::rank(MPI_COMM_WORLD);

  std::ostringstream quiet;
  std::streambuf* const terminal = std::cout.rdbuf();
  if (rank != 0) std::cout.rdbuf(quiet.rdbuf());
  const int failures = stickslip::test::run_catch(argc, argv);
  std::cout.rdbuf(terminal);
  if (rank != 0 && failures != 0) std::cout << "[rank " << rank << "]\n" << quiet.str();

  int worst = failures;
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return worst == 0 ? 0 : 1;
}
