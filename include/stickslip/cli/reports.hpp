#pragma once
/// What runs, studies and plans report.

#include <mpi.h>

#include <string>
#include <utility>
#include <vector>

#include "stickslip/cli/output.hpp"
#include "stickslip/cli/request.hpp"
#include "stickslip/cli/sweep.hpp"
#include "stickslip/run/carry_out.hpp"
#include "stickslip/run/study.hpp"

namespace stickslip::cli {

// Where a result comes from: versions, machine, time.

/// Name and text pairs: program, commit, scalar type, PETSc, SLEPc, MUMPS, MPI, BLAS, compiler,
/// host, ranks, date (UTC). Local.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance(MPI_Comm comm);

/// Such as "1.0.0".
[[nodiscard]] std::string version_number();

/// The lines of -version.
[[nodiscard]] std::string version_text();

/// Wall times of a run beside those of the solver statistics [s].
struct RunTimes {
  double start_up = 0;  ///< before this program's own work: dynamic linking, MPI and PETSc
  double total = 0;     ///< since the process began
};

/// What the outputs write. The text of a run has every number with its error, then what accuracy
/// cost; that of a study its tables and conclusions; that of a plan tasks, systems and solves, then
/// sizes and times by step. Reports refer to their arguments. Local.
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request, const run::Outcome& outcome,
                               const RunTimes& times);
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request, const run::Study& study,
                               const RunTimes& times);
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request,
                               const run::Prediction& prediction);

// What a sweep reports.

/// By rank 0 alone, which has the points: their scalars side by side as text, a row for each of
/// them, `runs` in the place of results, and every result as an array over the axes. Rows have no
/// times, so that an interrupted sweep ends with the same bytes as one in one go. The report refers
/// to request and sweep. Local.
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request, const SweepResult& sweep,
                               const RunTimes& times);

}  // namespace stickslip::cli
