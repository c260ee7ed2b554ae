#pragma once
/// -sweep_<option>: a run for each combination of values of some options of the model.

#include <mpi.h>

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/cli/options.hpp"
#include "stickslip/cli/request.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::cli {

/// An option of the model with the values it takes.
struct SweepAxis {
  std::string option;  ///< without the dash
  std::string unit;    ///< empty for pure numbers
  std::vector<double> values;
};

/// The product of the axes, in the order of the table of options; the last one changes fastest.
class Sweep {
 public:
  /// `settings` holds every other option.
  Sweep(Settings settings, std::vector<SweepAxis> axes);

  [[nodiscard]] const std::vector<SweepAxis>& axes() const { return axes_; }
  /// Number of points.
  [[nodiscard]] std::size_t size() const;
  /// Values of the axes at a point, 0 <= point < size().
  [[nodiscard]] std::vector<double> values(std::size_t point) const;
  /// "mu_d = 0.5, tau = 1".
  [[nodiscard]] std::string place(std::size_t point) const;

  /// The settings of a single run with the values of the point.
  [[nodiscard]] Settings settings(std::size_t point) const;
  /// What such a run would be asked, of a point that is not left out; it writes no files. Local.
  [[nodiscard]] Request request(std::size_t point) const;

  /// Points at which the model cannot be computed, such as mu_d above mu_s, with the reason.
  [[nodiscard]] const std::map<std::size_t, std::string>& left_out() const { return left_out_; }
  void leave_out(std::size_t point, std::string reason) { left_out_[point] = std::move(reason); }

  /// Name and value of every option that may change a number, those of the solvers included.
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& identity() const {
    return identity_;
  }

 private:
  Settings settings_;
  std::vector<SweepAxis> axes_;
  std::vector<std::pair<std::string, std::string>> identity_;
  std::map<std::size_t, std::string> left_out_;
};

// A finished point of a sweep.

/// How a point ended. Results are there for the first two.
enum class Status { reached, not_reached, failed, no_memory, refused };

/// "reached", "not reached", "failed", "no memory", "refused".
[[nodiscard]] const char* status_text(Status status);

struct SweepPoint {
  std::size_t point = 0;
  Status status = Status::reached;
  std::string message;          ///< what fell short; empty if nothing did
  quantities::Results results;  ///< values that are not finite are NaN
  double seconds = 0;           ///< that it took
  std::string entry;  ///< the same and scene, warnings, accuracy, cost, plan: an entry of `runs`
};

/// The run of an entry of `runs`, JSON in one line. Throws std::exception, nlohmann's too, if it is
/// none.
[[nodiscard]] SweepPoint read_run(std::string entry);

// The points of a sweep, distributed over groups of ranks.

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
[[nodiscard]] SweepResult run_sweep(MPI_Comm comm, const Request& request,
                                    const SweepProgress& progress);

/// 4 if a point lacked memory, else 3 if one fell short or was refused, else 0.
[[nodiscard]] int exit_status(const std::vector<SweepPoint>& runs);

}  // namespace stickslip::cli
