#include "read_force.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "csv_rows.hpp"
#include "sample_rows.hpp"
#include "stickslip/effects/read_scene.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kForceFile = "force_file", *kScale = "force_scale",
                     *kInterpolation = "force_interpolation";

// Where nine in ten samples are evenly spaced, a larger step is a gap; other records are uneven.
void require_no_gap(const CsvRows<2>& rows) {
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

model::ForceRecord read_record(const std::string& file) {
  CsvRows<2> rows;
  try {
    rows = read_csv<2>(file, {"time", "force"}, ::io::ignore_extra_column);
  } catch (const ::io::error::base& problem) {
    throw std::invalid_argument(fmt::format("is not a CSV file of a force: {}", problem.what()));
  }
  model::ForceRecord record;
  for (const auto& [time, force] : rows.values) {
    if (!record.time.empty() && !(time > record.time.back())) {
      throw std::invalid_argument(fmt::format("{}time = {:.9g} must be above {:.9g}, that of the "
                                              "sample before",
                                              rows.place(record.time.size()), time,
                                              record.time.back()));
    }
    record.time.push_back(time);
    record.force.push_back(force);
  }
  if (record.time.size() < 2) {
    throw std::invalid_argument(
        fmt::format("has {} samples, and a force over time takes 2", record.time.size()));
  }
  require_no_gap(rows);
  return record;
}

}  // namespace

std::vector<Option> force_options() {
  return {Option::file(kForceFile, Kind::input,
                       "CSV with the columns time,force: a force in the place of the noise. "
                       "-quantities trajectory is then the motion of a body from rest under it, "
                       "without random numbers",
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
              {.symbol = {}, .label = "scale of the force", .others = {"scale_factor", "pga"}})};
}

void read_force(Given& given, model::Scene& scene) {
  if (!given.has(kForceFile) || !layout_is_sound(given)) return;
  try {
    auto record = read_samples(given, given.text(kForceFile), read_record);
    record.file = given.text(kForceFile);
    if (given.has(kScale)) record.scale = given.real(kScale);
    record.constant = given.text(kInterpolation) == "constant";
    for (double& force : record.force) force *= record.scale;
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
