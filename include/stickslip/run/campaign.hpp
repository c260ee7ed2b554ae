#pragma once
/// Simulations, and the file of -checkpoint, from which a sweep or a simulation resumes.

#include <mpi.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::run {

/// Name and value of everything that may change a number.
using Identity = std::vector<std::pair<std::string, std::string>>;

/// A sweep appends an entry for each finished point, the only entry of a simulation is its state.
enum class CheckpointKind { sweep, simulation };

/// JSON lines: the first one has the identity, each further one is an entry, a JSON object with a
/// checksum (base/files.hpp).
class Checkpoint {
 public:
  /// Touches no file.
  Checkpoint(std::string file, CheckpointKind kind, const Identity& identity);

  /// Gets the text of an entry; what it throws makes the entry a damaged one.
  using Take = std::function<void(const std::string& entry)>;
  /// Hands the entries of the file to `take`, in their order, on the first rank, or makes the file.
  /// A last line of a sweep that was cut off when its writer was killed is removed. Collective.
  /// Throws BadInput on all ranks, and leaves the file alone, if it belongs to something else (the
  /// message names the difference) or is damaged; SystemFailure on the first rank when the
  /// disk refuses.
  void open(MPI_Comm comm, const Take& take) const;

  /// Adds an entry and flushes it to disk, whole or not at all. By one process at a time: others
  /// wait, on network file systems too. Throws SystemFailure when the disk refuses.
  void append(const std::string& entry) const;

  /// Puts an entry in the place of all others, in one step. By one process. Throws
  /// SystemFailure when the disk refuses.
  void replace(const std::string& entry) const;

 private:
  void read(const Take& take) const;
  [[noreturn]] void refuse(const std::string& why) const;
  [[noreturn]] void refuse_other(const std::string& header) const;

  std::string file_, kind_, header_;
};

// -route monte_carlo: the same quantities from simulated excursions, with confidence intervals.

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

}  // namespace stickslip::run
