#pragma once
/// What runs, studies and plans report.

#include <mpi.h>

#include "stickslip/accuracy/carry_out.hpp"
#include "stickslip/accuracy/prediction.hpp"
#include "stickslip/options/request.hpp"
#include "stickslip/outputs/report.hpp"
#include "stickslip/studies/study.hpp"

namespace stickslip::io {

/// Wall times of a run beside those of the solver statistics [s].
struct RunTimes {
  double start_up = 0;  ///< before this program's own work: dynamic linking, MPI and PETSc
  double total = 0;     ///< since the process began
};

/// What the outputs write. The text of a run has every number with its error, then what accuracy
/// cost; that of a study its tables and conclusions; that of a plan tasks, systems and solves, then
/// sizes and times by step. Reports refer to their arguments. Local.
[[nodiscard]] outputs::Report report_of(MPI_Comm comm, const options::Request& request,
                                        const accuracy::Outcome& outcome, const RunTimes& times);
[[nodiscard]] outputs::Report report_of(MPI_Comm comm, const options::Request& request,
                                        const studies::Study& study, const RunTimes& times);
[[nodiscard]] outputs::Report report_of(MPI_Comm comm, const options::Request& request,
                                        const accuracy::Prediction& prediction);

}  // namespace stickslip::io
