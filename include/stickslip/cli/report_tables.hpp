#pragma once
/// Tables of text for standard output.

#include <mpi.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "stickslip/cli/reports.hpp"

namespace stickslip::cli {

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

  /// `gap`: blanks between columns.
  explicit TextTable(std::vector<Column> columns, std::size_t gap = 2);

  /// A row; cells missing at its end are empty, and so are columns without title or cells.
  void add(std::vector<std::string> cells);
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
/// The columns that tell the size of a discretisation, and their cells.
[[nodiscard]] std::vector<TextTable::Column> size_columns(cases::Scheme scheme);
[[nodiscard]] std::vector<std::string> size_cells(const run::Resolution& resolution,
                                                  std::int64_t unknowns, std::int64_t nonzeros);
/// Entries of a matrix or factorisation; "-" for none, where they are not known.
[[nodiscard]] std::string count_text(double count);
/// A row for each refinement level: its size, memory, times and largest relative error estimate;
/// then iterations, and what the solution method reports of itself. Of a simulation its size.
[[nodiscard]] std::string cost_table(cases::Scheme scheme, const run::Outcome& outcome);
/// A number in a cell of CSV; nothing for NaN.
[[nodiscard]] std::string cell(double value, int digits);

[[nodiscard]] Json resolution_json(const run::Resolution& resolution);
[[nodiscard]] Json scene_json(const model::Scene& scene);
/// What one run found and what it cost: scene, results, accuracy, comparison if any, cost, plan.
/// `compared` is the name of the file of the references.
[[nodiscard]] Json run_json(const cases::Case& given, const run::Outcome& outcome,
                            const RunTimes& times, const std::string& compared = {});
[[nodiscard]] Json seconds_json(const linalg::SolverStatistics& statistics);
/// The beginning of a report: where it comes from, and what it took.
[[nodiscard]] Report report_from(MPI_Comm comm, const Request& request, Subject subject,
                                 const RunTimes& times);
/// The text of the report of a run.
[[nodiscard]] std::string run_table(const Request& request, const run::Outcome& outcome,
                                    const RunTimes& times);

}  // namespace stickslip::cli
