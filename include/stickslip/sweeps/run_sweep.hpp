#pragma once
/// The points of a sweep, distributed over groups of ranks.

#include <mpi.h>

#include <functional>
#include <vector>

#include "stickslip/options/sweep.hpp"
#include "stickslip/sweeps/sweep_point.hpp"

namespace stickslip::sweeps {

struct SweepResult {
  std::vector<SweepPoint> runs;  ///< by point; on rank 0 only
  std::size_t resumed = 0;       ///< of them from the checkpoint
};

/// How far a sweep is when a point has just been finished.
struct State {
  std::size_t point = 0;        ///< the one just finished
  std::size_t done = 0;         ///< of all points, those of the checkpoint included
  std::size_t count = 0;        ///< all points
  double seconds_left = 0;      ///< expected
  std::string status;           ///< how the point ended
  double seconds_of_point = 0;  ///< what it took
};

/// Called on the first rank of the group that finished a point.
using SweepProgress = std::function<void(const State&)>;

/// Computes what the checkpoint does not hold yet. Ranks work in groups of -sweep_ranks,
/// each with a communicator of its own; a group that is through takes the next point, which a
/// counter in the memory of rank 0 names. So no rank waits for another before the end, and the
/// numbers of a point do not depend on who computed it or after what. Each point goes to the
/// checkpoint as it is finished. Points that ended for lack of memory are tried again. Collective.
/// Throws BadInput on all ranks alike before anything is computed if the checkpoint belongs to
/// something else or is damaged.
[[nodiscard]] SweepResult run_sweep(MPI_Comm comm, const options::Request& request,
                                    const SweepProgress& progress);

/// 4 if a point lacked memory, else 3 if one fell short or was refused, else 0.
[[nodiscard]] int exit_status(const std::vector<SweepPoint>& runs);

}  // namespace stickslip::sweeps
