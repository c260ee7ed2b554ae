#pragma once
/// What a simulation needs to go on where it stopped.

#include <mpi.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stickslip::monte_carlo {

struct Checkpoint {
  /// Name and value of every option that fixes the numbers.
  std::vector<std::pair<std::string, std::string>> run;
  long rounds = 0;            ///< whole rounds in the tally
  std::vector<double> tally;  ///< packed
};

/// Reads `file` on rank 0 and hands it to all; nothing if there is none. Collective. Throws
/// BadInput, with the option that differs, unless it belongs to a run like `run`.
[[nodiscard]] std::optional<Checkpoint>
read_checkpoint(MPI_Comm comm, const std::string& file,
                const std::vector<std::pair<std::string, std::string>>& run);

/// Writes it to `file`, whole or not at all. By one process.
void write_checkpoint(const std::string& file, const Checkpoint& checkpoint);

}  // namespace stickslip::monte_carlo
