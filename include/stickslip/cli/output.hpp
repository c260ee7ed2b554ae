#pragma once
/// Forms in which results leave the program. Each is a file that declares its option, what it is
/// written of, and how; all else that speaks of them follows from these declarations.

#include <mpi.h>
#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/case/entry.hpp"
#include "stickslip/quantities/density.hpp"
#include "stickslip/quantities/relaxation.hpp"
#include "stickslip/quantities/results.hpp"
#include "stickslip/simulation/walk.hpp"

namespace stickslip::cli {

struct Report;

/// What the program does, and reports of.
enum class Subject { run, study, sweep, plan };

struct Output {
  std::string option = {};                 ///< that names the file; none for standard output
  std::string ending = {};                 ///< of such files, for messages
  std::string sentence = {};               ///< what it does, for the help of the option
  std::vector<std::string> synonyms = {};  ///< other names of the option
  std::set<Subject> subjects;              ///< what it is written of; of others it is left out
  /// The quantities that are no numbers of a table, and that it holds.
  std::set<cases::Quantity> fields = {};
  /// Whether all ranks of a report write it together; otherwise the first one does.
  bool collective = false;
  /// Throws SystemFailure when the file cannot be written.
  void (*write)(const Report&, const std::string& file);
};

/// All outputs, in the order in which they are listed and written.
[[nodiscard]] std::span<const Output* const> all();

/// Writes the outputs that have no option, and those whose options have files. Collective on the
/// ranks of the report. Throws what they throw.
void write_all(const Report& report, const std::map<std::string, std::string>& files);

/// Writes to standard output at once. Throws SystemFailure when it cannot be written.
void print(const std::string& text);

// Results as JSON, in summaries and in checkpoints of sweeps, and read from it.

// JSON for Modern C++: the common header-only writer; numbers are written so that they read back
// to the same bits. It takes seconds to compile: sources that make JSON include it, headers do not.
using Json = nlohmann::ordered_json;

/// An object with the results by their keys.
[[nodiscard]] Json results_json(const quantities::Results& results);

/// The results of such an object, with what it states of them. JSON has no word for what is not
/// finite: null is read as NaN. Throws Json::exception where something is missing or of another
/// type, and std::invalid_argument where values, errors and arguments differ in number.
[[nodiscard]] quantities::Results results_of(const Json& json);

// What runs, studies, sweeps and plans hand over to the outputs.

/// Names with texts.
using Texts = std::vector<std::pair<std::string, std::string>>;

/// Numbers over several indices, the last one fastest.
struct Array {
  std::string name;
  std::vector<std::size_t> sizes;
  std::vector<double> values;
  Texts notes = {};  ///< such as its unit
  /// Names of the arrays that label its indices, its own of one that labels; empty where an index
  /// has none.
  std::vector<std::string> axes = {};
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
  double speed_error = 0;                                 ///< see run::Outcome
  std::span<const quantities::RelaxationSector> modes{};  ///< if asked for
  const simulation::Path* path = nullptr;                 ///< if asked for
};

/// The tree with its provenance: what -summary writes.
[[nodiscard]] Json summary_of(const Report& report);

// Values of other origin to compare results with (-compare).

using cases::Reference;

/// Reads HDF5 or JSON written by this program (simulated or computed; errors of computed values
/// count as intervals), or CSV with a header and the columns quantity, argument, value, low, high;
/// an empty argument is a scalar, and empty bounds are no width. Histograms (f_slide, ...) of
/// simulations are left out: their distribution functions hold the same without cells. Throws
/// std::invalid_argument with what is wrong and where. Local.
[[nodiscard]] std::vector<Reference> read_references(const std::string& file);

}  // namespace stickslip::cli
