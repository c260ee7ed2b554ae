#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <vector>

#define CSV_IO_NO_THREAD  // small files
#include <libfccp/csv.h>

#include "reading.hpp"

namespace stickslip::options {

model::LevelTable read_levels(const std::string& file) {
  require_readable(file);
  std::vector<model::Level> levels;
  std::vector<unsigned> lines;
  try {
    ::io::CSVReader<3, ::io::trim_chars<' ', '\t', '\r'>, ::io::double_quote_escape<',', '"'>,
                    ::io::throw_on_overflow, ::io::single_and_empty_line_comment<'#'>>
        reader(file);
    reader.read_header(::io::ignore_no_column, "x", "rate_up", "rate_down");
    std::string x, up, down;
    while (reader.read_row(x, up, down)) {
      lines.push_back(reader.get_file_line());
      const auto number = [&](const char* column, const std::string& text) {
        if (const auto value = parse_number(text)) return *value;
        throw std::invalid_argument(
            fmt::format("line {}: {} = {} is no finite number", lines.back(), column, text));
      };
      levels.push_back({number("x", x), number("rate_up", up), number("rate_down", down)});
    }
  } catch (const ::io::error::base& problem) {
    throw std::invalid_argument(
        fmt::format("is not a CSV file of levels: {}. A record of a force or an acceleration over "
                    "time (CSV, AT2, SAC) becomes one as docs/recorded_forces.md shows",
                    problem.what()));
  }
  try {
    return model::LevelTable(levels);
  } catch (const model::UnfitTable& unfit) {
    const bool at_line = unfit.row() < lines.size();
    throw std::invalid_argument((at_line ? fmt::format("line {}: ", lines[unfit.row()]) : "") +
                                unfit.what());
  }
}

}  // namespace stickslip::options
