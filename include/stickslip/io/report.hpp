#pragma once
/// What runs, studies and plans report: tables, the JSON summary, HDF5, CSV (docs/output.md).

#include <mpi.h>

#include <string>

#include "stickslip/accuracy/prediction.hpp"
#include "stickslip/accuracy/refinement.hpp"
#include "stickslip/options/request.hpp"
#include "stickslip/studies/study.hpp"

namespace stickslip::io {

/// Wall times of a run beside those of the solver statistics [s].
struct RunTimes {
  double start_up = 0;  ///< before this program's own work: dynamic linking, MPI and PETSc
  double total = 0;     ///< since the process began
};

/// The table for standard output. Of a run, every number with its error, then what accuracy cost;
/// of a study, its tables and conclusions; of a plan, tasks, systems, solves, then sizes and times
/// by step.
[[nodiscard]] std::string table(const options::Request& request, const accuracy::Outcome& outcome,
                                const RunTimes& times);
[[nodiscard]] std::string table(const options::Request& request, const studies::Study& study,
                                const RunTimes& times);
[[nodiscard]] std::string table(const options::Request& request,
                                const accuracy::Prediction& prediction);

/// The JSON summary. Local.
[[nodiscard]] std::string summary(MPI_Comm comm, const options::Request& request,
                                  const accuracy::Outcome& outcome, const RunTimes& times);
[[nodiscard]] std::string summary(MPI_Comm comm, const options::Request& request,
                                  const studies::Study& study, const RunTimes& times);
[[nodiscard]] std::string summary(MPI_Comm comm, const options::Request& request,
                                  const accuracy::Prediction& prediction);

/// The columns time, x, y, v.
[[nodiscard]] std::string csv(const simulation::Path& path);
/// Every scalar of every run in a row.
[[nodiscard]] std::string csv(const studies::Study& study);

/// Writes -output: results, options, provenance, and the density field if it was asked for, with
/// FILE.xdmf beside it; of a study, its tables. Collective. Throws std::runtime_error when the disk
/// refuses.
void write_hdf5(MPI_Comm comm, const options::Request& request, const accuracy::Outcome& outcome,
                const RunTimes& times);
void write_hdf5(MPI_Comm comm, const options::Request& request, const studies::Study& study,
                const RunTimes& times);

}  // namespace stickslip::io
