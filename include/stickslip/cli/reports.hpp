#pragma once
/// What runs, studies and plans report.

#include <mpi.h>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/cli/output.hpp"
#include "stickslip/cli/request.hpp"
#include "stickslip/cli/sweep.hpp"
#include "stickslip/run/carry_out.hpp"
#include "stickslip/run/study.hpp"

namespace stickslip::cli {

// Where a result comes from: versions, machine, time.

/// Name and text pairs: program, commit, scalar type, PETSc, SLEPc, MUMPS, MPI, BLAS, compiler,
/// host, ranks, date (UTC). Local.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> provenance(MPI_Comm comm);

/// Such as "1.0.0".
[[nodiscard]] std::string version_number();

/// The lines of -version.
[[nodiscard]] std::string version_text();

/// Wall times of a run beside those of the solver statistics [s].
struct RunTimes {
  double start_up = 0;  ///< before this program's own work: dynamic linking, MPI and PETSc
  double total = 0;     ///< since the process began
};

/// What the outputs write. The text of a run has every number with its error, then what accuracy
/// cost; that of a study its tables and conclusions; that of a plan tasks, systems and solves, then
/// sizes and times by step. Reports refer to their arguments. Local.
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request, const run::Outcome& outcome,
                               const RunTimes& times);
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request, const run::Study& study,
                               const RunTimes& times);
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request,
                               const run::Prediction& prediction);

// What a sweep reports.

/// By rank 0 alone, which has the points: their scalars side by side as text, a row for each of
/// them, `runs` in the place of results, and every result as an array over the axes. Rows have no
/// times, so that an interrupted sweep ends with the same bytes as one in one go. The report refers
/// to request and sweep. Local.
[[nodiscard]] Report report_of(MPI_Comm comm, const Request& request, const SweepResult& sweep,
                               const RunTimes& times);

// Tables of text for standard output.

/// What printed tables keep to where their content allows.
inline constexpr std::size_t kLineWidth = 100;

/// Rows of cells in aligned columns, each as wide as its widest cell.
class TextTable {
 public:
  struct Column {
    std::string title;
    bool left = false;       ///< aligned at the left; numbers are at the right
    std::string above = {};  ///< a line of the title over `title`
  };

  /// A cell with the column that it stands in.
  using Cell = std::pair<Column, std::string>;

  /// `gap`: blanks between columns.
  explicit TextTable(std::vector<Column> columns, std::size_t gap = 2);

  /// A row; cells missing at its end are empty, and so are columns without title or cells.
  void add(std::vector<std::string> cells);
  /// A row of a table that was made without columns: those of the first row are its columns.
  void add_titled(const std::vector<Cell>& cells);
  /// A line across all columns.
  void add_line(std::string line);

  /// Titles and rows, without blanks at the ends of lines.
  [[nodiscard]] std::string text() const;

 private:
  struct Row {
    std::vector<std::string> cells;
    std::string line;  // if there are none
  };
  [[nodiscard]] std::vector<std::size_t> widths() const;

  std::vector<Column> columns_;
  std::vector<Row> rows_;
  std::size_t gap_;
};

/// Parts of a description one after the other, three blanks between, on lines of kLineWidth.
[[nodiscard]] std::string spaced(std::span<const std::string> parts);

// Parts that reports of runs, studies, plans and sweeps share.

/// The model parameters, on as many lines as they take.
[[nodiscard]] std::string scene_text(const model::Scene& scene);
/// The size of a discretisation. A velocity discretisation comes with a linear system; the fluid
/// queue has neither.
[[nodiscard]] std::vector<TextTable::Cell> size_cells(const run::Resolution& resolution,
                                                      std::int64_t unknowns, std::int64_t nonzeros);
/// Entries of a matrix or factorisation; "-" for none, where they are not known.
[[nodiscard]] std::string count_text(double count);
/// A number in a cell of CSV; nothing for NaN.
[[nodiscard]] std::string cell(double value, int digits);

[[nodiscard]] Json scene_json(const model::Scene& scene);
/// What one run found and what it cost: scene, results, accuracy, comparison if any, cost, plan.
/// `compared` is the name of the file of the references.
[[nodiscard]] Json run_json(const cases::Case& given, const run::Outcome& outcome,
                            const RunTimes& times, const std::string& compared = {});
/// The beginning of a report: where it comes from, and what it took.
[[nodiscard]] Report report_from(MPI_Comm comm, const Request& request, Subject subject,
                                 const RunTimes& times);
/// The text of the report of a run.
[[nodiscard]] std::string run_table(const Request& request, const run::Outcome& outcome,
                                    const RunTimes& times);

}  // namespace stickslip::cli
