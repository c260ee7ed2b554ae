#include <fmt/format.h>

#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "all.hpp"
#include "levels.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kPulseHeight = "pulse_height", *kPulseRate = "pulse_rate",
                     *kPulseDuration = "pulse_duration", *kPulseDecay = "pulse_decay",
                     *kPulseSteps = "pulse_steps", *kPulseSign = "pulse_sign";

constexpr double kNoWeight = 1e-18;

// P(N >= n) of the number of pulses at work, of a mean.
double weight(int n, double mean) {
  if (n == 0) return 1;
  return mean > 0 ? boost::math::gamma_p(n, mean) : 0;
}

// So many pulses at once that more have no weight.
int most_pulses(double mean) {
  require_number_of_states(mean);
  int most = 1;
  while (weight(most + 1, mean) > kNoWeight) ++most;
  return most;
}

// Pulses of either sign, each of which ends by itself: the numbers of those at work, up to so many
// of both at once that more have no weight.
States pulses_that_end(double height, double up, double down, double duration) {
  require_number_of_states((1 + up * duration) * (1 + down * duration));  // at least
  std::map<std::pair<int, int>, std::size_t> known;
  States states;
  for (int n = 0; weight(n, up * duration) > kNoWeight; ++n) {
    const double left = kNoWeight / weight(n, up * duration);
    for (int m = 0; weight(m, down * duration) > left; ++m) {
      known.emplace(std::pair(n, m), states.x.size());
      states.x.push_back((n - m) * height);
    }
  }
  require_number_of_states(static_cast<double>(states.x.size()));
  const auto link = [&](std::size_t here, std::pair<int, int> more, double begins, int at_work) {
    const auto there = known.find(more);
    if (there == known.end()) return;
    states.transitions.push_back({here, there->second, begins});
    states.transitions.push_back({there->second, here, at_work / duration});
  };
  for (const auto& [numbers, here] : known) {
    const auto [n, m] = numbers;
    link(here, {n + 1, m}, up, n + 1);
    link(here, {n, m + 1}, down, m + 1);
  }
  return states;
}

// Forces in steps of height/steps that fall towards 0, each step at the rate 1/decay, and jump by a
// height at a time.
States pulses_that_decay(double height, double up, double down, double decay, int steps) {
  const int most = steps * most_pulses((up + down) * decay * (1 + std::log(steps))),
            lowest = down > 0 ? -most : 0, highest = up > 0 ? most : 0;
  require_number_of_states(highest - lowest + 1.0);
  States states;
  for (int n = lowest; n <= highest; ++n) {
    states.x.push_back(n * height / steps);
    const auto jump = [&](int to, double rate) {
      if (to == n || !(rate > 0)) return;
      states.transitions.push_back(
          {static_cast<std::size_t>(n - lowest), static_cast<std::size_t>(to - lowest), rate});
    };
    const int up_to = std::min(n + steps, highest), down_to = std::max(n - steps, lowest),
              nearer = n > 0 ? n - 1 : n + 1;
    const double fall = std::abs(n) / decay;
    jump(up_to, up + (n < 0 && up_to == nearer ? fall : 0));
    jump(down_to, down + (n > 0 && down_to == nearer ? fall : 0));
    if (n != 0 && nearer != up_to && nearer != down_to) jump(nearer, fall);
  }
  return states;
}

model::LevelTable pulse_levels(const model::Scene& scene) {
  const double height = own_number(scene, kPulseHeight), rate = own_number(scene, kPulseRate);
  const auto& sign = std::get<std::string>(own_value(scene, kPulseSign));
  const double up = sign == "down" ? 0 : sign == "up" ? rate : rate / 2, down = rate - up;
  for (const auto& [name, value] : scene.own) {
    if (name != kPulseDecay) continue;
    return pulses_that_decay(height, up, down, std::get<double>(value),
                             static_cast<int>(own_number(scene, kPulseSteps)))
        .table();
  }
  return pulses_that_end(height, up, down, own_number(scene, kPulseDuration)).table();
}

bool complete_pulses(Given& given, model::Scene& scene) {
  if (given.has(kPulseDuration) == given.has(kPulseDecay)) {
    given.refuse("noise", fmt::format("needs either -{} or -{}", kPulseDuration, kPulseDecay),
                 fmt::format("give one of them, for example -{} 0.5", kPulseDuration));
  } else if (given.has(kPulseDuration) && given.has(kPulseSteps)) {
    given.refuse(kPulseSteps, "belongs to -pulse_decay", "leave it out, or take -pulse_decay");
  }
  if (given.has(kPulseDuration)) {
    std::erase_if(scene.own, [](const auto& each) { return each.first == kPulseSteps; });
  }
  return make_levels(given, scene, kPulseRate, "take a smaller -pulse_rate or shorter pulses");
}

}  // namespace

const Effect kPulses{
    .word = "pulses",
    .sentence = "pulses at the times of a Poisson process, which add up",
    .others = {"shots", "shot_noise", "poisson", "kicks"},
    .parameters =
        {{Option::real(kPulseHeight, "force", "", Range::positive(),
                       "force of one of the -noise pulses", "take for example 2",
                       {.symbol = "h",
                        .label = "height of the pulses",
                        .slider = Slider{.low = 0.2, .high = 5, .start = 2}}),
          true, "2"},
         {Option::real(
              kPulseRate, "1/time", "", Range::positive(), "rate of the -noise pulses",
              "take for example 1",
              {.symbol = "\\nu",
               .label = "rate of the pulses",
               .slider = Slider{.low = 0.05, .high = 10, .start = 1, .logarithmic = true}}),
          true, "1"},
         {Option::real(
              kPulseDuration, "time", "", Range::positive(),
              "mean duration of the -noise pulses, which is exponential: the force is constant "
              "until it ends",
              "take for example 0.5",
              {.symbol = "T_p",
               .label = "duration of the pulses",
               .slider = Slider{.low = 0.02, .high = 5, .start = 0.5, .logarithmic = true}}),
          true},
         {Option::real(kPulseDecay, "time", "", Range::positive(),
                       "time in which the -noise pulses decay by a factor e, in -pulse_steps steps",
                       "take for example 0.5",
                       {.symbol = "T_d", .label = "decay time of the pulses"}),
          true},
         {Option::integer(kPulseSteps, "8", Range::whole(1, 1e4),
                          "number of steps by which pulses of -pulse_decay fall; many of them are "
                          "an exponential",
                          "take for example 8", {}, {.symbol = "m", .label = "steps of the decay"}),
          true},
         {{kPulseSign,
           Kind::choice,
           "word",
           "",
           "both",
           {},
           {"both", "up", "down"},
           "direction of the -noise pulses; with both, half of them have each",
           ""},
          true}},
    .complete = complete_pulses,
    .levels = pulse_levels,
    .stronger = [](const model::Scene&) -> std::string { return "a larger -pulse_height"; }};

}  // namespace stickslip::effects
