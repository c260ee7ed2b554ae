#pragma once
/// Memory that this run may still take.

#include <mpi.h>

namespace stickslip::petsc {

/// Bytes that all ranks of `comm` together can still allocate: what the machines have free, what
/// control groups and the address-space limit (ulimit -v) leave. A machine's memory counts as
/// shared evenly by all ranks on it, those outside `comm` too. Collective.
[[nodiscard]] double available_bytes(MPI_Comm comm);

/// Ranks of this run on this machine. The first call is collective on MPI_COMM_WORLD; Session makes
/// it.
int ranks_on_node();

/// Largest resident size of this process so far [bytes].
[[nodiscard]] double peak_resident_bytes();

}  // namespace stickslip::petsc
