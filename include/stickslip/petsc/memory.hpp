#pragma once
/// Memory that this run may still take.

#include <mpi.h>

namespace stickslip::petsc {

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

/// Ranks of this run on this machine. The first call is collective on MPI_COMM_WORLD; Session makes
/// it.
int ranks_on_node();

/// Largest resident size of this process so far [bytes].
[[nodiscard]] double peak_resident_bytes();

}  // namespace stickslip::petsc
