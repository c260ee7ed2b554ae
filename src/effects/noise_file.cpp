#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <vector>

#define CSV_IO_NO_THREAD  // small files
#include <libfccp/csv.h>

#include "all.hpp"
#include "levels.hpp"
#include "stickslip/effects/noise_file.hpp"
#include "stickslip/support/number_text.hpp"
#include "stickslip/support/readable.hpp"

namespace stickslip::effects {

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

namespace {

constexpr const char* kFile = "noise_file";

void read_noise_file(Given& given, model::Scene& scene) {
  if (!given.needs("noise", kFile, "levels.csv")) return;
  const std::string file = given.text(kFile);
  scene.own.emplace_back(kFile, file);
  set_levels(given, scene, kFile, "write CSV with the columns x,rate_up,rate_down, x rising",
             [&file] { return read_levels(file); });
}

}  // namespace

const Effect kNoiseFile{
    .word = "file",
    .sentence = "any birth-death chain",
    .parameters = {{Option::file(kFile, Kind::input,
                                 "CSV with the columns x,rate_up,rate_down: the levels of -noise "
                                 "file in rising order, and the rates of jumps to the next level "
                                 "up and down, 0 at the ends",
                                 {.label = "levels of",
                                  .others = {"record", "recording", "force_file", "force_record",
                                             "forcing", "data"},
                                  .page = "docs/recorded_forces.md"}),
                    true}},
    .read = read_noise_file,
    .complete = has_levels,
    .heading = [](const model::Scene& scene) {
      return "noise levels of " + std::get<std::string>(own_value(scene, kFile));
    }};

}  // namespace stickslip::effects
