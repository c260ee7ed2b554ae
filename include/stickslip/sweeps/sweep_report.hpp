#pragma once
/// What a sweep reports.

#include <mpi.h>

#include "stickslip/io/reports.hpp"
#include "stickslip/sweeps/run_sweep.hpp"

namespace stickslip::sweeps {

/// By rank 0 alone, which has the points: their scalars side by side as text, a row for each of
/// them, `runs` in the place of results, and every result as an array over the axes. Rows have no
/// times, so that an interrupted sweep ends with the same bytes as one in one go. The report refers
/// to request and sweep. Local.
[[nodiscard]] outputs::Report report_of(MPI_Comm comm, const options::Request& request,
                                        const SweepResult& sweep, const io::RunTimes& times);

}  // namespace stickslip::sweeps
