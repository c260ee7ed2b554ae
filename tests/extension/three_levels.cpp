#include "all.hpp"
#include "levels.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kForce = "pulse_force", *kPulses = "pulse_rate", *kEnds = "pulse_end_rate";

void read_three_levels(Given& given, model::Scene& scene) {
  if (!given.needs("noise", kForce, "2")) return;
  const double a = given.real(kForce), pulses = given.real(kPulses), ends = given.real(kEnds);
  scene.own.insert(scene.own.end(), {{kForce, a}, {kPulses, pulses}, {kEnds, ends}});
  set_levels(given, scene, kForce, "take for example -pulse_force 2", [=] {
    return model::LevelTable({{-a, ends, 0}, {0, pulses, pulses}, {a, 0, ends}});
  });
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
                    true},
                   {Option::real(
                        kPulses, "1/time", "1", Range::positive(), "rate of the pulses of one sign",
                        "take for example 1",
                        {.symbol = "\\nu",
                         .label = "rate of the pulses",
                         .slider =
                             Slider{.low = 0.05, .high = 10, .start = 0.5, .logarithmic = true}}),
                    true},
                   {Option::real(kEnds, "1/time", "1", Range::positive(),
                                 "rate at which a pulse ends", "take for example 1"),
                    true}},
    .read = read_three_levels,
    .complete = has_levels};

}  // namespace stickslip::effects
