#include <boost/math/special_functions/gamma.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "all.hpp"
#include "csv_rows.hpp"
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

namespace {

std::vector<std::string> words_of(const model::Scene& scene) {
  return noises().parts(scene.noise.name);
}

// The scene with one of its noises alone, whose levels are not made yet.
model::Scene part_of(const model::Scene& scene, const std::string& word) {
  model::Scene part = scene;
  part.noise.name = word;
  part.noise.table.reset();
  for (const auto& [name, value] : scene.own) {
    if (name == kLevels) part.noise_levels = static_cast<int>(std::get<double>(value));
  }
  return part;
}

model::Scene made_part(const model::Scene& scene, const std::string& word) {
  auto part = part_of(scene, word);
  make_noise_levels(part);
  return part;
}

void read_sum(Given& given, model::Scene& scene) {
  const auto words = words_of(scene);
  const auto share = [&words](const char* option) {
    return std::count_if(words.begin(), words.end(), [option](const std::string& word) {
             return noises().of(word).knows(option);
           }) > 1;
  };
  if (share(kDeviation)) {
    return given.refuse("noise", fmt::format("joins two noises that take -{}", kDeviation),
                        "write the sum as -noise chain, as docs/any_noise.md shows");
  }
  const std::string all = scene.noise.name;
  std::vector<std::function<double(double)>> targets;
  std::vector<model::CovarianceTerm> terms;
  std::vector<std::string> continuous;
  for (const auto& word : words) {
    scene.noise.name = word;
    scene.noise.target = {};
    read_effect(given, noises(), word, scene);
    targets.push_back(scene.noise.target);
    const auto gaussian = std::exchange(scene.noise.gaussian, nullptr);
    if (!gaussian) continue;
    continuous.push_back(word);
    terms.insert(terms.end(), gaussian->terms().begin(), gaussian->terms().end());
  }
  scene.noise.name = all;
  if (continuous.size() == words.size()) {
    return make_continuous(given, scene, terms, "noise", "take fewer parts");
  }
  const bool by_steps = noises().knows(scene, kDelta);
  for (const auto& word : continuous) {
    given.refuse("noise", fmt::format("adds chains, and {} noise is none", word),
                 by_steps ? "give -delta 0, with which ou is Gaussian noise as well"
                          : "add up in Python, where lattice(delta) makes a chain of such a noise");
  }
  const bool known = std::all_of(targets.begin(), targets.end(), [](const auto& f) { return !!f; });
  scene.noise.target = {};
  if (known) {
    scene.noise.target = [targets](double omega) {
      double sum = 0;
      for (const auto& target : targets) sum += target(omega);
      return sum;
    };
  }
  // The levels of one part are no range of the sum.
  if (scene.noise_levels) scene.own.emplace_back(kLevels, static_cast<double>(*scene.noise_levels));
  scene.noise_levels.reset();
}

model::LevelTable levels_of_sum(const model::Scene& scene) {
  States all{{0}, {}};
  for (const auto& word : words_of(scene)) {
    const auto chain = made_part(scene, word).meant().noise;
    // In the order that the noise gives its states, so that those of the sum can be told apart;
    // some may be left out.
    const auto listed = [&chain](int level) {
      return chain.table ? chain.table->listed(level)
                         : static_cast<std::size_t>(level - chain.lowest());
    };
    std::vector<std::size_t> kept;
    for (int i = chain.lowest(); i <= chain.highest(); ++i) kept.push_back(listed(i));
    std::ranges::sort(kept);
    const auto number = [&](int level) {
      return static_cast<std::size_t>(std::ranges::lower_bound(kept, listed(level)) - kept.begin());
    };
    States part;
    part.x.resize(static_cast<std::size_t>(chain.count()));
    for (int i = chain.lowest(); i <= chain.highest(); ++i) {
      part.x[number(i)] = chain.level(i);
      chain.for_each_jump(i, [&](int to, double rate) {
        part.transitions.push_back({number(i), number(to), rate});
      });
    }
    all = sum(all, part);
  }
  return all.table();
}

bool complete_sum(Given& given, model::Scene& scene) {
  if (scene.noise.gaussian) return complete_continuous(given, scene);
  for (const auto& word : words_of(scene)) {
    auto part = part_of(scene, word);
    if (!given.sound() || !noises().of(word).complete(given, part)) return false;
  }
  return make_levels(given, scene, "noise",
                     "take larger steps, fewer -noise_levels or fewer phases");
}

std::string heading_of_sum(const model::Scene& scene) {
  std::vector<std::string> parts;
  for (const auto& word : words_of(scene)) {
    for (const auto& part : heading(noises().of(word), scene)) parts.push_back(part);
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

const Effect kNoiseSum{.word = "+",
                       .sentence = "the sum of independent noises",
                       .read = read_sum,
                       .complete = complete_sum,
                       .levels = levels_of_sum,
                       .heading = heading_of_sum};

}  // namespace stickslip::effects
