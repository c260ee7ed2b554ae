#include "stickslip/io/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stickslip::io {
namespace {

std::string without_blanks_at_end(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

}  // namespace

TextTable::TextTable(std::vector<Column> columns, std::size_t gap)
    : columns_(std::move(columns)), gap_(gap) {}

void TextTable::add(std::vector<std::string> cells) {
  cells.resize(columns_.size());
  rows_.push_back({std::move(cells), ""});
}

void TextTable::add_line(std::string line) { rows_.push_back({{}, std::move(line)}); }

std::vector<std::size_t> TextTable::widths() const {
  std::vector<std::size_t> widths;
  for (const Column& column : columns_) {
    widths.push_back(std::max(column.title.size(), column.above.size()));
  }
  for (const Row& row : rows_) {
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      widths[c] = std::max(widths[c], row.cells[c].size());
    }
  }
  return widths;
}

std::string TextTable::text() const {
  const auto width = widths();
  const auto line = [&](const auto& cell) {
    std::string text;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      text += c == 0 ? "" : std::string(gap_, ' ');
      text += columns_[c].left ? fmt::format("{:<{}}", cell(c), width[c])
                               : fmt::format("{:>{}}", cell(c), width[c]);
    }
    return without_blanks_at_end(std::move(text));
  };
  const bool two_lines = std::any_of(columns_.begin(), columns_.end(),
                                     [](const Column& column) { return !column.above.empty(); });
  std::string text;
  if (two_lines) text += line([&](std::size_t c) { return columns_[c].above; });
  text += line([&](std::size_t c) { return columns_[c].title; });
  for (const Row& row : rows_) {
    text += row.cells.empty() ? without_blanks_at_end(row.line)
                              : line([&](std::size_t c) { return row.cells[c]; });
  }
  return text;
}

std::string spaced(std::span<const std::string> parts) {
  std::string text;
  std::size_t length = 0;  // of the last line
  for (const std::string& part : parts) {
    const bool fits = length + 3 + part.size() <= kLineWidth;
    if (!text.empty()) text += fits ? "   " : "\n";
    length = text.empty() || !fits ? part.size() : length + 3 + part.size();
    text += part;
  }
  return text + "\n";
}

}  // namespace stickslip::io
