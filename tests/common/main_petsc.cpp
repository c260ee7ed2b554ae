/// Starts PETSc around Catch2: the same cases run on every rank, only rank 0 reports unless another
/// rank fails.

#define CATCH_CONFIG_RUNNER
#include <mpi.h>
#include <sched.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <iostream>
#include <sstream>
#include <thread>
#include <utility>

#include "stickslip/petsc/blas.hpp"
#include "stickslip/petsc/session.hpp"

/// Open MPI calls this where a rank waits and there are more ranks than cores. The system's own
/// lets the scheduler come back at once; beside other load, ranks that wait then take the time of
/// those that work. Here a rank that has waited for long sleeps.
extern "C" int sched_yield() noexcept {
  using Clock = std::chrono::steady_clock;
  constexpr auto pause = std::chrono::microseconds(50), working = std::chrono::microseconds(100);
  constexpr int patience = 200;
  static Clock::time_point last;
  static int waits = 0;
  const auto now = Clock::now();
  if (now - std::exchange(last, now) > working) waits = 0;
  if (++waits > patience) std::this_thread::sleep_for(pause);
  return 0;
}

int main(int argc, char** argv) {
  int petsc_argc = 1;  // Catch2's flags are no PETSc options; those come by PETSC_OPTIONS
  const stickslip::petsc::Session session(petsc_argc, argv);
  stickslip::petsc::keep_blas_to_one_thread();
  const int rank = stickslip::petsc::rank(MPI_COMM_WORLD);

  std::ostringstream quiet;
  std::streambuf* const terminal = std::cout.rdbuf();
  if (rank != 0) std::cout.rdbuf(quiet.rdbuf());
  const int failures = Catch::Session().run(argc, argv);
  std::cout.rdbuf(terminal);
  if (rank != 0 && failures != 0) std::cout << "[rank " << rank << "]\n" << quiet.str();

  int worst = failures;
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return worst == 0 ? 0 : 1;
}
