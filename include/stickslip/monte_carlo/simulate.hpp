#pragma once
/// -route monte_carlo: the same quantities from simulated excursions, with confidence intervals.

#include <mpi.h>

#include <functional>
#include <string>

#include "stickslip/cases/case.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::monte_carlo {

/// How far a simulation is.
struct SimulationState {
  double excursions = 0, wanted = 0;  ///< done, and to be done at most
  double jumps = 0;                   ///< of the noise, so far
  double seconds = 0;                 ///< since this run began
  double seconds_left = 0;            ///< as predicted; 0 while nothing is known
};

/// Called on the first rank now and then.
using SimulationProgress = std::function<void(const SimulationState&)>;

struct Simulated {
  quantities::Results results;  ///< error: half the width of the 95 % confidence interval
  SimulationState state;        ///< at the end
  double continued_from = 0;    ///< excursions found in the checkpoint
  bool reached = false;         ///< the accuracy asked for, if one was, or all excursions
  std::string shortfall;
};

/// Simulates given.method.excursions excursions, or fewer if -accuracy is given and met before;
/// without symmetry pairs of them, one from each side, and with each a path for functions of time.
/// Batches of them have random streams of their own, are distributed over the ranks, and merged in
/// their order: the numbers depend on the model parameters, the seed and the excursions alone. With
/// a file name in `checkpoint` the tally is read from that file if it exists, and written to it
/// every few seconds. Collective. Throws BadInput when the checkpoint belongs to another run or is
/// damaged, and when it would take more than a month.
[[nodiscard]] Simulated simulate(MPI_Comm comm, const cases::Case& given,
                                 const std::string& checkpoint, const SimulationProgress& progress);

}  // namespace stickslip::monte_carlo
