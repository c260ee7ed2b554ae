#pragma once
/// The file of -checkpoint, from which a sweep or a simulation resumes.

#include <mpi.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::checkpoint {

/// Name and value of everything that may change a number.
using Identity = std::vector<std::pair<std::string, std::string>>;

/// A sweep appends an entry for each finished point, the only entry of a simulation is its state.
enum class Kind { sweep, simulation };

/// JSON lines: the first one has the identity, each further one is an entry, a JSON object with a
/// checksum (support/seal.hpp).
class Checkpoint {
 public:
  /// Touches no file.
  Checkpoint(std::string file, Kind kind, const Identity& identity);

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

}  // namespace stickslip::checkpoint
