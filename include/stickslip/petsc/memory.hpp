#pragma once
/// Memory that this run may still take.

#include <mpi.h>

namespace stickslip::petsc {

/// Bytes that all ranks of `comm` together can still allocate: what the machines have free, what
/// control groups and the address-space limit (ulimit -v) leave. Collective.
[[nodiscard]] double available_bytes(MPI_Comm comm);

/// Largest resident size of this process so far [bytes].
[[nodiscard]] double peak_resident_bytes();

}  // namespace stickslip::petsc
