#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "all.hpp"
#include "csv_rows.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/model/effect.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kLayout = "sample_layout", *kStep = "sample_step", *kRest = "force_rest";

model::ForceRecord read_rows(const std::string& file, double step) {
  require_readable(file);
  model::ForceRecord record;
  std::ifstream lines(file);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.starts_with('#')) continue;
    std::ranges::replace_if(
        line, [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const auto value = parse_number(word);
      if (!value) {
        throw std::invalid_argument(fmt::format("line {}: {} is no finite number", number, word));
      }
      record.time.push_back(step * static_cast<double>(record.time.size()));
      record.force.push_back(*value);
    }
  }
  if (record.time.size() < 2) {
    throw std::invalid_argument(
        fmt::format("has {} samples, and a force over time takes 2", record.time.size()));
  }
  return record;
}

// Whether a layout has a step, and columns none; refuses what is not so.
bool layout_is_sound(Given& given) {
  const bool rows = given.text(kLayout) == "rows";
  if (rows == given.has(kStep)) return true;
  given.refuse(rows ? kLayout : kStep, rows ? "rows have no times" : "has no effect on columns",
               rows ? "add -sample_step, the time between two samples, such as -sample_step 0.005"
                    : "leave it out, or add -sample_layout rows");
  return false;
}

// The samples of -force_file: those of rows if -sample_layout says so, else what `columns` reads.
// No force for the time of -force_rest follows, from one step behind the last sample on. Throws
// std::invalid_argument with the line of what is no finite number.
model::ForceRecord read_samples(const Given& given, const std::string& file,
                                model::ForceRecord (*columns)(const std::string&)) {
  auto record = given.has(kStep) ? read_rows(file, given.real(kStep)) : columns(file);
  if (given.has(kStep)) record.step = given.real(kStep);
  if (!given.has(kRest) || given.real(kRest) == 0) return record;
  record.rest = given.real(kRest);
  const double last = record.time.back(), end = last + record.rest;
  const double next = last + (last - record.time[record.time.size() - 2]);
  for (const double time : {std::min(next, end), end}) {
    if (!(time > record.time.back())) continue;
    record.time.push_back(time);
    record.force.push_back(0);
    if (!record.load.empty()) record.load.push_back(0);
  }
  return record;
}

constexpr const char *kForceFile = "force_file", *kScale = "force_scale",
                     *kInterpolation = "force_interpolation", *kGravity = "force_gravity";
constexpr const char *kVertical = "vertical", *kUnit = "# unit: ", *kAcceleration = "m/s^2";
constexpr double kStandardGravity = 9.80665;  // m/s^2, by the CGPM of 1901

// Where nine in ten samples are evenly spaced, a larger step is a gap; other records are uneven.
template <std::size_t columns>
void require_no_gap(const CsvRows<columns>& rows) {
  const auto step = [&](std::size_t n) { return rows.values[n][0] - rows.values[n - 1][0]; };
  std::vector<double> steps;
  for (std::size_t n = 1; n < rows.values.size(); ++n) steps.push_back(step(n));
  const auto median = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), median, steps.end());
  const double usual = *median;
  constexpr double alike = 0.05, missing = 1.5, most = 0.9;
  const auto even =
      std::ranges::count_if(steps, [&](double h) { return std::abs(h - usual) <= alike * usual; });
  if (static_cast<double>(even) < most * static_cast<double>(steps.size())) return;
  for (std::size_t n = 1; n < rows.values.size(); ++n) {
    if (step(n) <= missing * usual) continue;
    const bool last = n + 1 == rows.values.size() && rows.values[n][1] == 0;
    if (last && rows.values[n - 1][1] == 0) continue;  // no force from one to the other
    throw std::invalid_argument(fmt::format(
        "{}time = {:.9g} follows {:.9g}, where steps are {:g}: samples are missing{}",
        rows.place(n), rows.values[n][0], rows.values[n - 1][0], usual,
        last ? fmt::format("; for no force at the end leave this one out and add -force_rest {:g}",
                           step(n))
             : ""));
  }
}

/// What stands before the samples: names of columns, and comments above or below them.
struct Head {
  std::string unit;
  bool vertical = false;  // whether there is such a column
};

Head read_head(const std::string& file) {
  require_readable(file);
  Head head;
  std::ifstream lines(file);
  bool named = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kUnit)) head.unit = split(line.substr(std::strlen(kUnit)), '\r').at(0);
    if (line.empty() || line.starts_with('#')) continue;
    if (std::exchange(named, true)) break;
    for (auto& name : split(line, ',')) {
      std::erase_if(name, [](char c) { return c == '"' || c == '\r'; });
      head.vertical = head.vertical || name == kVertical;
    }
  }
  if (head.unit.empty() || head.unit == kAcceleration) return head;
  throw std::invalid_argument(fmt::format("unit: {}: must be {}", head.unit, kAcceleration));
}

// Time, force and, of three columns, vertical acceleration.
template <std::size_t columns>
model::ForceRecord read_columns(const std::string& file,
                                const std::array<const char*, columns>& names) {
  CsvRows<columns> rows;
  try {
    rows = read_csv<columns>(file, names, ::io::ignore_extra_column);
  } catch (const ::io::error::base& problem) {
    throw std::invalid_argument(fmt::format("is not a CSV file of a force: {}", problem.what()));
  }
  model::ForceRecord record;
  for (const auto& row : rows.values) {
    if (!record.time.empty() && !(row[0] > record.time.back())) {
      throw std::invalid_argument(fmt::format("{}time = {:.9g} must be above {:.9g}, that of the "
                                              "sample before",
                                              rows.place(record.time.size()), row[0],
                                              record.time.back()));
    }
    record.time.push_back(row[0]);
    record.force.push_back(row[1]);
    if (columns > 2) record.load.push_back(row[columns - 1]);
  }
  if (record.time.size() < 2) {
    throw std::invalid_argument(
        fmt::format("has {} samples, and a force over time takes 2", record.time.size()));
  }
  require_no_gap(rows);
  return record;
}

model::ForceRecord read_record(const std::string& file) {
  const Head head = read_head(file);
  auto record = head.vertical ? read_columns<3>(file, {"time", "force", kVertical})
                              : read_columns<2>(file, {"time", "force"});
  record.unit = head.unit;
  return record;
}

// From vertical accelerations to normal forces over the weight. A body that lifts off moves freely,
// which is another model.
void read_load(Given& given, const model::Scene& scene, model::ForceRecord& record) {
  if (record.load.empty()) return;
  if (scene.friction_name != "coulomb") {
    return given.refuse("friction", "does not go with a column vertical of -force_file",
                        "leave -friction out, or the column");
  }
  if (!given.has(kGravity) && record.unit.empty()) {
    return given.refuse(
        kForceFile, "has a column vertical, and its unit is not known",
        "add -force_gravity in the unit of that column, such as -force_gravity 9.81");
  }
  const double gravity = given.has(kGravity) ? given.real(kGravity) : kStandardGravity;
  record.gravity = gravity;
  for (std::size_t n = 0; n < record.load.size(); ++n) {
    const double vertical = std::abs(record.scale) * record.load[n];
    record.load[n] = 1 + vertical / gravity;
    if (record.load[n] >= 0) continue;
    return given.refuse(kForceFile,
                        fmt::format("lifts the body off the ground at time {:g}, where the "
                                    "vertical acceleration {:g} is below -force_gravity = {:g}",
                                    record.time[n], vertical, gravity),
                        "take a -force_scale closer to 0, or leave the column vertical out");
  }
}

}  // namespace

std::vector<Option> force_options() {
  return {
      Option::file(kForceFile, Kind::input,
                   "CSV with the columns time,force: a force in the place of the noise. "
                   "-quantities given_force is then the motion of a body under it, without random "
                   "numbers",
                   {.symbol = {},
                    .label = "force of",
                    .others = {"accelerogram", "ground_motion", "time_history"},
                    .page = "docs/given_force.md"}),
      {kInterpolation,
       Kind::choice,
       "word",
       "",
       "",
       {},
       {"linear", "constant"},
       "the force of -force_file between two samples. linear: from one to the other, unless "
       "this option is given. constant: that of the first",
       ""},
      Option::real(
          kScale, "", "", {}, "factor of the forces of -force_file; 1 unless given",
          "take for example -9.81 for a ground acceleration in g, which pushes a body "
          "the other way",
          {.symbol = {}, .label = "scale of the force", .others = {"scale_factor", "pga"}}),
      Option::real(
          kGravity, "", "", Range::positive(),
          "acceleration of gravity, where -force_file has a column vertical: the "
          "vertical acceleration a of the ground multiplies friction by 1 + a/force_gravity, "
          "with a times |-force_scale|; 9.80665 for files in m/s^2",
          "in the unit of that column, after scaling"),
      {kLayout,
       Kind::choice,
       "word",
       "",
       "",
       {},
       {"columns", "rows"},
       "how -force_file holds its samples. columns: below the names time,force, unless this "
       "option is given. rows: one after the other in rows, without times and names",
       ""},
      Option::real(kStep, "time", "", Range::positive(),
                   "time between two samples of -sample_layout rows",
                   "take for example 0.005, that of 200 samples in a second"),
      Option::real(kRest, "time", "", Range::not_negative(),
                   "time without force that is appended to -force_file; 0 unless given",
                   "take as long as the body needs to stop")};
}

void read_force(Given& given, model::Scene& scene) {
  if (!given.has(kForceFile) || !layout_is_sound(given)) return;
  try {
    auto record = read_samples(given, given.text(kForceFile), read_record);
    record.file = given.text(kForceFile);
    if (given.has(kScale)) record.scale = given.real(kScale);
    record.constant = given.text(kInterpolation) == "constant";
    for (double& force : record.force) force *= record.scale;
    read_load(given, scene, record);
    scene.force = std::make_shared<const model::ForceRecord>(std::move(record));
  } catch (const std::invalid_argument& unfit) {
    given.refuse(
        kForceFile, unfit.what(),
        "write CSV with the columns time,force and their names in the first line, times "
        "rising, commas between numbers and points within, or add -sample_layout rows where rows "
        "hold samples; python3 -m stickslip force FILE "
        "writes it of AT2, V2, and tables with other names and units");
  }
}

std::string force_note(const model::Scene& scene) {
  if (!scene.force) return "";
  if (!scene.force->load.empty()) return "";
  const auto [low, high] = std::ranges::minmax(scene.force->force);
  const double up = scene.friction.mu_s - scene.bias;
  const double down = scene.friction.mirrored().mu_s + scene.bias;
  if (high > up || -low > down) return "";
  return fmt::format(
      "the body never moves: forces of {} reach from {:.4g} to {:.4g}, and friction holds it from "
      "{:.4g} to {:.4g}; are both in one unit, and has the force the right sign? -force_scale "
      "changes these",
      scene.force->file, low, high, -down, up);
}

}  // namespace stickslip::effects
