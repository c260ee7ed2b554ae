#pragma once
/// A finished point of a sweep.

#include <mpi.h>

#include <cstddef>
#include <string>

#include "stickslip/options/request.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::sweeps {

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

/// Computes a point on its own; failures of solvers and of memory become its status. Collective.
/// Throws what is no stickslip::Failure.
[[nodiscard]] SweepPoint compute_run(MPI_Comm comm, const options::Request& given,
                                     std::size_t point);

/// A point at which the model cannot be computed, for the reason given. Local.
[[nodiscard]] SweepPoint refused_run(std::size_t point, const std::string& reason);

/// The run of an entry of `runs`, JSON in one line. Throws std::exception, nlohmann's too, if it is
/// none.
[[nodiscard]] SweepPoint read_run(std::string entry);

}  // namespace stickslip::sweeps
