#pragma once
/// Start and end of MPI, PETSc and SLEPc.

#include <mpi.h>

#include <string>
#include <vector>

namespace stickslip::linalg {

// Memory that this run may still take.

/// The message where the factors do not fit.
inline constexpr const char* kFactorsTooLarge =
    "the factors need more memory than there is; use a larger -delta, a looser -accuracy or more "
    "ranks";

/// Bytes that all ranks of `comm` together can still allocate: what the machines have free, what
/// control groups and the address-space limit (ulimit -v) leave. A machine's memory counts as
/// shared evenly by all ranks on it, those outside `comm` too. If that is less than `wanted`, the C
/// library first gives back what it keeps of freed memory. Collective.
[[nodiscard]] double available_bytes(MPI_Comm comm, double wanted);

/// Bytes that the limit of the address space (ulimit -v) leaves this process; infinity without one.
[[nodiscard]] double left_in_address_space();

/// Largest resident size of this process so far [bytes].
[[nodiscard]] double peak_resident_bytes();

// Which BLAS this process uses. It decides the speed of a factorisation.

struct Blas {
  std::string library;  ///< path of the shared library that provides dgemm
  bool reference;       ///< the unoptimised reference implementation, several times slower here
};

/// Looks the loaded library up; local, microseconds.
[[nodiscard]] Blas loaded_blas();

/// Under a limit of the address space, starts the program anew with one thread for OpenBLAS. That
/// makes its threads while it is loaded, before main(); without space for their work they try for
/// ever, and the end of the program would wait for them. Takes as long as loading the program, and
/// returns where there is no limit or the environment names a number of threads.
void restart_with_one_blas_thread(char** arguments);

/// Keeps an OpenBLAS to one thread unless the environment names a number: the blocks of these
/// factorisations are too small to gain from threads, and ranks share the cores.
void keep_blas_to_one_thread();

/// Operations a second of a matrix product of the size of the fronts that occur here, measured in
/// a few milliseconds on the calling process.
[[nodiscard]] double measured_speed();

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

/// The text of the lowest rank that has one, so that what one rank alone finds ends all ranks
/// alike; empty if none has. Collective.
[[nodiscard]] std::string first_text(MPI_Comm comm, std::string text);

/// Throws NotReached on all ranks, with the first of the texts, if any rank has one. Collective.
void require_everywhere(MPI_Comm comm, const std::string& failure);

}  // namespace stickslip::linalg
