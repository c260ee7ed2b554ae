#pragma once
/// Tables of text for standard output.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace stickslip::io {

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

}  // namespace stickslip::io
