#pragma once
/// What runs, studies, sweeps and plans hand over to the outputs.

#include <mpi.h>

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/outputs/output.hpp"
#include "stickslip/outputs/results_json.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/simulation/path.hpp"

namespace stickslip::outputs {

/// Names with texts.
using Texts = std::vector<std::pair<std::string, std::string>>;

/// Numbers over several indices, the last one fastest.
struct Array {
  std::string name;
  std::vector<std::size_t> sizes;
  std::vector<double> values;
  Texts notes = {};  ///< such as its unit
};

/// Arrays that belong together.
struct Grid {
  Texts notes;
  std::vector<Array> arrays;
};

/// All that was found, in forms that outputs need only put down. It refers to what it was made of,
/// which has to outlive it. The ranks of `comm` have equal reports, but for the rows of fields.
struct Report {
  Subject subject = Subject::run;
  MPI_Comm comm = MPI_COMM_NULL;  ///< the ranks that have the report
  Texts provenance, options;      ///< where it comes from, and every option as used
  std::vector<std::string> warnings = {};
  double seconds = 0;  ///< wall time of all
  std::string text;    ///< for people
  /// Everything but provenance, fields and paths, by the keys of docs/output.md. It is made when
  /// called, as are rows and grid: those of a long sweep take memory.
  std::function<Json()> tree;
  /// Of studies, sweeps and paths under a given force: titles of columns, then their cells.
  std::function<std::vector<std::vector<std::string>>()> rows = {};
  /// Of sweeps: every result over the axes.
  std::function<Grid()> grid = {};

  const quantities::DensityField* density = nullptr;      ///< if asked for
  double speed_error = 0;                                 ///< see accuracy::Outcome
  std::span<const quantities::RelaxationSector> modes{};  ///< if asked for
  const simulation::Path* path = nullptr;                 ///< if asked for
};

/// The tree with its provenance: what -summary writes.
[[nodiscard]] Json summary_of(const Report& report);

}  // namespace stickslip::outputs
