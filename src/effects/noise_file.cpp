#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "all.hpp"
#include "csv_rows.hpp"
#include "levels.hpp"
#include "stickslip/effects/noise_file.hpp"

namespace stickslip::effects {

model::LevelTable read_levels(const std::string& file) {
  CsvRows<3> rows;
  try {
    rows = read_csv<3>(file, {"x", "rate_up", "rate_down"}, ::io::ignore_no_column);
  } catch (const ::io::error::base& problem) {
    throw std::invalid_argument(
        fmt::format("is not a CSV file of levels: {}. A record of a force or an acceleration over "
                    "time (CSV, AT2, SAC) becomes one as docs/recorded_forces.md shows",
                    problem.what()));
  }
  std::vector<model::Level> levels;
  for (const auto& [x, up, down] : rows.values) levels.push_back({x, up, down});
  try {
    return model::LevelTable(levels);
  } catch (const model::UnfitTable& unfit) {
    throw std::invalid_argument(rows.place(unfit.row()) + unfit.what());
  }
}

namespace {

constexpr const char* kFile = "noise_file";

bool complete_noise_file(Given& given, model::Scene& scene) {
  return make_levels(given, scene, kFile,
                     "write CSV with the columns x,rate_up,rate_down, x rising");
}

model::LevelTable levels_of_file(const model::Scene& scene) {
  return read_levels(std::get<std::string>(own_value(scene, kFile)));
}

}  // namespace

const Effect kNoiseFile{
    .word = "file",
    .sentence = "any birth-death chain",
    .parameters = {{Option::file(
                        kFile, Kind::input,
                        "CSV with the columns x,rate_up,rate_down: the levels of -noise "
                        "file in rising order, and the rates of jumps to the next level "
                        "up and down, 0 at the ends",
                        {.label = "levels of",
                         .others = {"record", "recording", "force_record", "forcing", "data"},
                         .page = "docs/recorded_forces.md"}),
                    true, "levels.csv"}},
    .complete = complete_noise_file,
    .levels = levels_of_file,
    .heading = [](const model::Scene& scene) {
      return "noise levels of " + std::get<std::string>(own_value(scene, kFile));
    }};

}  // namespace stickslip::effects
