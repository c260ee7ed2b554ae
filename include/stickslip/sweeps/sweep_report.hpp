#pragma once
/// What a sweep reports: table, CSV, JSON, HDF5. All by rank 0 alone, which has the runs.

#include <mpi.h>

#include <string>

#include "stickslip/io/report.hpp"
#include "stickslip/sweeps/run_sweep.hpp"

namespace stickslip::sweeps {

/// Values and scalars of every point for standard output, four scalars side by side.
[[nodiscard]] std::string table(const options::Request& request, const SweepResult& sweep,
                                const io::RunTimes& times);

/// A row for each point: its values, each scalar with its error, status. Without times, so that an
/// interrupted sweep ends with the same bytes as one in one go.
[[nodiscard]] std::string csv(const options::Request& request, const SweepResult& sweep);

/// The JSON summary: the axes, and `runs` in the place of results.
[[nodiscard]] std::string summary(MPI_Comm comm, const options::Request& request,
                                  const SweepResult& sweep, const io::RunTimes& times);

/// Writes -output: every result as an array over the axes of the sweep. Local. Throws
/// std::runtime_error when the disk refuses.
void write_hdf5(MPI_Comm comm, const options::Request& request, const SweepResult& sweep,
                const io::RunTimes& times);

}  // namespace stickslip::sweeps
