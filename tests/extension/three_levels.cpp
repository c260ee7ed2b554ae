#include "all.hpp"
#include "levels.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kForce = "step_force", *kStepRate = "step_rate", *kEnds = "step_end_rate";

model::LevelTable three_levels(const model::Scene& scene) {
  const double a = own_number(scene, kForce), pulses = own_number(scene, kStepRate),
               ends = own_number(scene, kEnds);
  return model::LevelTable({{-a, ends, 0}, {0, pulses, pulses}, {a, 0, ends}});
}

bool complete_three_levels(Given& given, model::Scene& scene) {
  return make_levels(given, scene, kForce, "take for example -step_force 2");
}

}  // namespace

const Effect kThreeLevels{
    .word = "three_levels",
    .sentence = "pulses of either sign with pauses between them",
    .parameters = {{Option::real(kForce, "force", "", Range::positive(), "force of a pulse",
                                 "take for example 2",
                                 {.symbol = "F",
                                  .label = "force of a pulse",
                                  .slider = Slider{.low = 1, .high = 5, .start = 2}}),
                    true, "2"},
                   {Option::real(
                        kStepRate, "1/time", "1", Range::positive(),
                        "rate of the pulses of one sign", "take for example 1",
                        {.symbol = "\\nu",
                         .label = "rate of the pulses",
                         .slider =
                             Slider{.low = 0.05, .high = 10, .start = 0.5, .logarithmic = true}}),
                    true},
                   {Option::real(kEnds, "1/time", "1", Range::positive(),
                                 "rate at which a pulse ends", "take for example 1"),
                    true}},
    .complete = complete_three_levels,
    .levels = three_levels};

}  // namespace stickslip::effects
