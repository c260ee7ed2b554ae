#include "literal_table.hpp"

#include <fmt/format.h>

#include "stickslip/support/text.hpp"

namespace stickslip::options {
namespace {

std::vector<std::string> cells_of(std::string_view line) {
  constexpr std::string_view bar = " | ";
  std::vector<std::string> cells;
  while (true) {
    const auto end = line.find(bar);
    const auto cell = line.substr(0, end);
    cells.emplace_back(cell == "-" ? "" : cell);
    if (end == line.npos) return cells;
    line.remove_prefix(end + bar.size());
  }
}

}  // namespace

std::vector<std::vector<std::string>> rows_of(std::string_view table, std::size_t columns) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& line : split(table, '\n')) {
    if (line.empty()) continue;
    rows.push_back(cells_of(line));
    if (rows.back().size() != columns) {
      throw std::logic_error(
          fmt::format("{} cells, not {}: {}", rows.back().size(), columns, line));
    }
  }
  return rows;
}

}  // namespace stickslip::options
