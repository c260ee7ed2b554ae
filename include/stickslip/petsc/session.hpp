#pragma once
/// Start and end of MPI, PETSc and SLEPc.

#include <mpi.h>

#include <string>
#include <vector>

namespace stickslip::petsc {

/// Starts MPI, PETSc and SLEPc; ends them when it dies. One per process.
///
/// Outside mpiexec, Open MPI's search for a daemon to join takes most of the start-up time of a
/// small run; the search is switched off (0.3 s become 0.05 s). The files .petscrc and petscrc are
/// not read, so that a run depends on what its command line names, and on PETSC_OPTIONS.
class Session {
 public:
  /// Collective. Throws PetscFailure when PETSc refuses the arguments.
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  std::vector<char*> arguments_;  // PETSc keeps a pointer to them
};

/// Whether PETSc computes with complex scalars.
[[nodiscard]] bool complex_scalars();

/// Whether a launcher (mpiexec, srun) has started this process, and waits for it.
[[nodiscard]] bool under_mpiexec();

/// Rank and size of a communicator.
[[nodiscard]] int rank(MPI_Comm comm);
[[nodiscard]] int ranks(MPI_Comm comm);

/// Adds the values of all ranks up, entry by entry. Collective.
void sum_over_ranks(MPI_Comm comm, std::vector<double>& values);

/// The text of the lowest rank that has one, so that what one rank alone finds ends all ranks
/// alike; empty if none has. Collective.
[[nodiscard]] std::string first_text(MPI_Comm comm, std::string text);

/// Throws NotReached on all ranks, with the first of the texts, if any rank has one. Collective.
void require_everywhere(MPI_Comm comm, const std::string& failure);

}  // namespace stickslip::petsc
