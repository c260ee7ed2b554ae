#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "all.hpp"
#include "levels.hpp"
#include "ou_noise.hpp"

namespace stickslip::effects {
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
  for (const auto& word : words) {
    scene.noise.name = word;
    scene.noise.target = {};
    read_effect(given, noises(), word, scene);
    targets.push_back(scene.noise.target);
  }
  scene.noise.name = all;
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

std::string note_of_sum(const model::Scene& scene) {
  std::vector<std::string> notes;
  for (const auto& word : words_of(scene)) {
    const auto note = noises().of(word).note;
    if (note == nullptr) continue;
    const std::string said = note(made_part(scene, word));
    if (!said.empty()) notes.push_back(said);
  }
  return fmt::format("{}", fmt::join(notes, "; "));
}

}  // namespace

const Effect kNoiseSum{.word = "+",
                       .sentence = "the sum of independent noises",
                       .read = read_sum,
                       .complete = complete_sum,
                       .levels = levels_of_sum,
                       .heading = heading_of_sum,
                       .note = note_of_sum};

}  // namespace stickslip::effects
