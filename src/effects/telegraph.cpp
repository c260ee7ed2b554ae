#include <fmt/format.h>

#include "all.hpp"
#include "levels.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kAmplitude = "telegraph_amplitude", *kRate = "telegraph_rate";

model::LevelTable telegraph_levels(const model::Scene& scene) {
  const double a = own_number(scene, kAmplitude), rate = own_number(scene, kRate);
  return model::LevelTable({{-a, rate, 0}, {a, 0, rate}});
}

bool complete_telegraph(Given& given, model::Scene& scene) {
  return make_levels(given, scene, kRate,
                     "take for example -telegraph_amplitude 1 -telegraph_rate 1");
}

std::string telegraph_text(const model::Scene& scene) {
  return fmt::format("telegraph noise a = {:g}, rate = {:g}", own_number(scene, kAmplitude),
                     own_number(scene, kRate));
}

}  // namespace

const Effect kTelegraph{
    .word = "telegraph",
    .sentence = "two levels",
    .others = {"dichotomous", "two_level", "rtn", "run_and_tumble", "rtp", "active"},
    .parameters =
        {{Option::real(kAmplitude, "force", "", Range::positive(),
                       "amplitude a of -noise telegraph, X = a or -a", "take for example 1",
                       {.symbol = "a",
                        .label = "amplitude of the noise",
                        .slider = Slider{.low = 0.1, .high = 3, .start = 1}}),
          true, "1"},
         {Option::real(
              kRate, "1/time", "", Range::positive(),
              "rate of the jumps between a and -a; the correlation time is "
              "1/(2 rate)",
              "take for example 1",
              {.symbol = "\\kappa",
               .label = "rate of the jumps",
               .slider = Slider{.low = 0.05, .high = 10, .start = 1, .logarithmic = true}}),
          true, "1"}},
    .complete = complete_telegraph,
    .levels = telegraph_levels,
    .heading = telegraph_text};

}  // namespace stickslip::effects
