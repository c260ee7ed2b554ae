#pragma once
/// What a run tells: the table, the JSON summary, the HDF5 file.

#include <mpi.h>

#include <string>

#include "stickslip/accuracy/refinement.hpp"
#include "stickslip/options/request.hpp"

namespace stickslip::io {

/// Wall times of a run beside those in the ledgers [s].
struct RunTimes {
  double start_up = 0;  ///< before this program's own work: dynamic linking, MPI and PETSc
  double total = 0;     ///< since the process began
};

/// The table for standard output: every number with its error, then what accuracy cost.
[[nodiscard]] std::string table(const options::Request& request, const accuracy::Outcome& outcome,
                                const RunTimes& times);

/// The JSON summary (the layout is described in docs/output.md).
[[nodiscard]] std::string summary(MPI_Comm comm, const options::Request& request,
                                  const accuracy::Outcome& outcome, const RunTimes& times);

/// The columns time, x, y, v.
[[nodiscard]] std::string trajectory_csv(const simulation::Path& path);

/// Writes -output: results, steps, options, provenance, and the density field if it was asked
/// for, with FILE.xdmf beside it. Collective. Throws std::runtime_error when the disk refuses.
void write_hdf5(MPI_Comm comm, const options::Request& request, const accuracy::Outcome& outcome,
                const RunTimes& times);

}  // namespace stickslip::io
