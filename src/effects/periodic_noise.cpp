#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "all.hpp"
#include "csv_rows.hpp"
#include "levels.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kPeriodicAmplitude = "periodic_amplitude", *kPeriod = "period",
                     *kPhases = "period_phases", *kShape = "period_shape";

// The force at each phase, over the amplitude.
std::vector<double> shape_of(const model::Scene& scene) {
  std::vector<double> shape;
  double phases = 0;
  bool sine = true;
  for (const auto& [name, value] : scene.own) {
    if (name == kPhases) phases = std::get<double>(value);
    if (name != kShape) continue;
    sine = false;
    const auto rows = read_csv<1>(std::get<std::string>(value), {"x"}, ::io::ignore_extra_column);
    for (const auto& row : rows.values) shape.push_back(row[0]);
  }
  if (!sine && phases != 0 && phases != static_cast<double>(shape.size())) {
    throw std::invalid_argument(
        fmt::format("holds {} phases, but -{} is {:g}", shape.size(), kPhases, phases));
  }
  for (int k = 0; sine && k < phases; ++k)
    shape.push_back(std::sin(2 * std::numbers::pi * k / phases));
  return shape;
}

model::LevelTable periodic_levels(const model::Scene& scene) {
  States states;
  states.x = shape_of(scene);
  const std::size_t count = states.x.size();
  require_number_of_states(static_cast<double>(count));
  if (count < 3) throw std::invalid_argument("holds fewer than three phases");
  const double rate = static_cast<double>(count) / own_number(scene, kPeriod);
  for (std::size_t k = 0; k < count; ++k) {
    states.x[k] *= own_number(scene, kPeriodicAmplitude);
    states.transitions.push_back({k, (k + 1) % count, rate});
  }
  return states.table();
}

bool complete_periodic(Given& given, model::Scene& scene) {
  if (given.has(kShape) && !given.has(kPhases)) {
    std::erase_if(scene.own, [](const auto& each) { return each.first == kPhases; });
  }
  return make_levels(given, scene, given.has(kShape) ? kShape : kPhases,
                     "write CSV with the column x, the force at three or more phases, as many as "
                     "-period_phases where that is given");
}

}  // namespace

const Effect kPeriodic{
    .word = "periodic",
    .sentence = "a force that repeats itself, through phases at the rate -period_phases over "
                "-period",
    .others = {"sine", "sinusoidal", "cosine", "cyclic"},
    .parameters =
        {{Option::real(kPeriodicAmplitude, "force", "", Range::positive(),
                       "amplitude of -noise periodic, A sin(2 pi t/period), or the factor of "
                       "-period_shape",
                       "take for example 1",
                       {.symbol = "A",
                        .label = "amplitude of the periodic force",
                        .slider = Slider{.low = 0.1, .high = 3, .start = 1.2}}),
          true, "1"},
         {Option::real(kPeriod, "time", "", Range::positive(), "mean period of -noise periodic",
                       "take for example 4",
                       {.symbol = "T",
                        .label = "period of the force",
                        .slider = Slider{.low = 0.5, .high = 50, .start = 4, .logarithmic = true}}),
          true, "4"},
         {Option::integer(
              kPhases, "16", Range::whole(3, 1e4),
              "number of phases of -noise periodic. Each lasts for an exponential time, "
              "so that the period has the relative deviation phases^(-1/2)",
              "take for example 16", {}, {.symbol = "K", .label = "phases of the periodic force"}),
          true},
         {Option::file(kShape, Kind::input,
                       "CSV with the column x: the force at each phase of -noise periodic, in the "
                       "place of the sine",
                       {.label = "shape of"}),
          true}},
    .complete = complete_periodic,
    .levels = periodic_levels,
    .stronger = [](const model::Scene&) -> std::string { return "a larger -periodic_amplitude"; }};

}  // namespace stickslip::effects
