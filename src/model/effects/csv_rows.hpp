#pragma once
/// Numbers from the CSV files that noises and given forces take.

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#define CSV_IO_NO_THREAD  // small files
#include <libfccp/csv.h>

#include "stickslip/base/text.hpp"

namespace stickslip::effects {

/// The numbers of some columns, and the line of each row.
template <std::size_t columns>
struct CsvRows {
  std::vector<std::array<double, columns>> values;
  std::vector<unsigned> lines;

  /// "line 5: ", or nothing if there is no such row.
  [[nodiscard]] std::string place(std::size_t row) const {
    return row < lines.size() ? fmt::format("line {}: ", lines[row]) : "";
  }
};

/// Reads the columns of these names, with blanks, quotes and lines that begin with # as people
/// write them; `others` says whether there may be more columns. Throws std::invalid_argument with
/// the line of what is no finite number, and io::error::base for what is no such file.
template <std::size_t columns>
[[nodiscard]] CsvRows<columns> read_csv(const std::string& file,
                                        const std::array<const char*, columns>& names,
                                        ::io::ignore_column others) {
  require_readable(file);
  ::io::CSVReader<columns, ::io::trim_chars<' ', '\t', '\r'>, ::io::double_quote_escape<',', '"'>,
                  ::io::throw_on_overflow, ::io::single_and_empty_line_comment<'#'>>
      reader(file);
  std::apply([&](auto... each) { reader.read_header(others, each...); }, names);
  CsvRows<columns> rows;
  std::array<std::string, columns> text;
  const auto next = [&] {
    return std::apply([&](auto&... each) { return reader.read_row(each...); }, text);
  };
  while (next()) {
    rows.lines.push_back(reader.get_file_line());
    auto& row = rows.values.emplace_back();
    for (std::size_t c = 0; c < columns; ++c) {
      const auto value = parse_number(text[c]);
      if (!value) {
        throw std::invalid_argument(fmt::format("line {}: {} = {} is no finite number",
                                                rows.lines.back(), names[c], text[c]));
      }
      row[c] = *value;
    }
  }
  return rows;
}

}  // namespace stickslip::effects
