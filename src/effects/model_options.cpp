#include "stickslip/effects/model_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "read_force.hpp"
#include "sample_rows.hpp"
#include "stickslip/effects/effect.hpp"

namespace stickslip::effects {
namespace {

// The option of a choice, and those of its effects. What an earlier one has declared is left out.
void append(const Choice& all, std::vector<Option>& options) {
  std::vector<std::string> words, meanings;
  for (const auto* effect : all.effects) {
    words.emplace_back(effect->word);
    meanings.push_back(fmt::format("{}: {}", effect->word, effect->sentence));
  }
  options.push_back({std::string(all.option),
                     Kind::choice,
                     "word",
                     "",
                     words.front(),
                     {},
                     words,
                     fmt::format("{}. {}", all.title, fmt::join(meanings, ". ")),
                     "",
                     {},
                     all.sum != nullptr});
  for (const auto* effect : all.effects) {
    for (const auto& parameter : effect->parameters) {
      const auto& name = parameter.option.name;
      const bool declared = std::any_of(options.begin(), options.end(),
                                        [&name](const Option& o) { return o.name == name; });
      if (!declared) options.push_back(parameter.option);
    }
  }
}

std::vector<Option> made() {
  std::vector<Option> all{
      Option::real(
          "mu_s", "force", "1", Range::positive(),
          "static friction coefficient: a body at rest sticks while the force is at most mu_s",
          "friction must be able to hold the body",
          {.symbol = "\\mu_s",
           .label = "static friction",
           .slider = Slider{.low = 0.1, .high = 3, .start = 1},
           .others = {"static_friction", "yield_acceleration", "critical_acceleration", "ky"}}),
      Option::real(
          "mu_d", "force", "1", Range::not_negative(),
          "dynamic friction coefficient, at most mu_s; the smaller of 1 and mu_s unless given",
          "friction must not drive the body",
          {.symbol = "\\mu_d",
           .label = "dynamic friction",
           .slider = Slider{.low = 0.05, .high = 3, .start = 0.5},
           .others = {"mu", "mu_k", "friction_coefficient", "dynamic_friction",
                      "kinetic_friction"}}),
      Option::real(
          "mu_s_minus", "force", "", Range::positive(),
          "static friction coefficient against motion towards negative v; mu_s unless given. "
          "Where the directions differ, both velocity branches are computed",
          "friction must be able to hold the body",
          {.symbol = "\\mu_s^-",
           .label = "static friction towards negative velocities",
           .slider = Slider{.low = 0.1, .high = 3}}),
      Option::real(
          "mu_d_minus", "force", "", Range::not_negative(),
          "dynamic friction coefficient while v < 0, at most mu_s_minus; mu_d unless given",
          "friction must not drive the body",
          {.symbol = "\\mu_d^-",
           .label = "dynamic friction towards negative velocities",
           .slider = Slider{.low = 0.05, .high = 3}})};
  for (const auto* each : choices()) append(*each, all);
  for (const auto& force : {force_options(), sample_options()})
    all.insert(all.end(), force.begin(), force.end());
  const std::vector<Option> others{
      Option::real(
          "bias", "force", "0", {},
          "constant force g added to X, such as the weight along an inclined plane. It breaks the "
          "symmetry: both velocity branches are computed",
          "take for example 0.1",
          {.symbol = "g",
           .label = "bias",
           .slider = Slider{.low = -0.9, .high = 0.9, .start = 0},
           .others = {"g", "force", "gravity", "slope"}}),
      Option::real(
          "v_max", "velocity", "", Range::positive(),
          "truncation velocity: bodies that reach it wait there until the noise falls. Unless "
          "given, the largest velocity that matters at -accuracy",
          kChosen),
      Option::real(
          "speed_limit", "velocity", "", Range::positive(),
          "largest speed of the body: forces that would drive it beyond are lost, as the inflow of "
          "a full buffer is. A part of the model, where -v_max only truncates it",
          "leave it out for a body that is as fast as forces make it")};
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

}  // namespace

const std::vector<Option>& model_options() {
  static const auto all = made();
  return all;
}

const Option& model_option(std::string_view name) {
  for (const auto& option : model_options()) {
    if (option.name == name) return option;
  }
  throw std::logic_error(fmt::format("-{} is no option of the model", name));
}

}  // namespace stickslip::effects
