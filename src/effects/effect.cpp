#include "stickslip/effects/effect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "all.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::effects {
namespace {

model::Parameters values_in(const Effect& effect, const model::Scene& scene) {
  auto all = effect.values != nullptr ? effect.values(scene) : model::Parameters{};
  for (const auto& each : scene.own) {
    if (effect.knows(each.first)) all.push_back(each);
  }
  return all;
}

}  // namespace

bool Effect::knows(std::string_view option) const {
  return std::any_of(parameters.begin(), parameters.end(),
                     [option](const Parameter& p) { return p.option.name == option; });
}

const Effect& Choice::of(std::string_view word) const {
  static const Effect nothing{};
  if (word.empty()) return nothing;
  if (sum != nullptr && word.find('+') != std::string_view::npos) return *sum;
  const auto found = std::find_if(effects.begin(), effects.end(),
                                  [word](const Effect* effect) { return effect->word == word; });
  return found != effects.end() ? **found : *effects.front();
}

std::vector<std::string> Choice::parts(const std::string& word) const {
  return sum != nullptr ? split(word, '+') : std::vector{word};
}

bool Choice::knows(const model::Scene& scene, std::string_view name) const {
  const auto words = parts(word_in(scene));
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& word) { return of(word).knows(name); });
}

const Choice& frictions() {
  static const Choice choice{
      "friction", "friction law", kFrictions,
      [](const model::Scene& s) -> const std::string& { return s.friction_name; }};
  return choice;
}

const Choice& noises() {
  static const Choice choice{
      "noise", "noise X", kNoises,
      [](const model::Scene& s) -> const std::string& { return s.noise.name; }, &kNoiseSum};
  return choice;
}

const Choice& drags() {
  static const Choice choice{
      "drag", "drag law b(v)", kDrags,
      [](const model::Scene& s) -> const std::string& { return s.drag_name; }};
  return choice;
}

std::span<const Choice* const> choices() {
  static const Choice* const all[] = {&frictions(), &noises(), &drags()};
  return all;
}

void read_effect(Given& given, const Choice& choice, const std::string& word, model::Scene& scene) {
  const auto& effect = choice.of(word);
  bool complete = true;
  for (const auto& [option, refused, example] : effect.parameters) {
    if (example.empty() || given.has(option.name)) continue;
    given.refuse(std::string(choice.option), fmt::format("needs -{}", option.name),
                 fmt::format("add for example -{} {}", option.name, example));
    complete = false;
  }
  if (!complete) return;
  if (effect.read != nullptr) return effect.read(given, scene);
  for (const auto& parameter : effect.parameters) {
    const auto& [name, kind] = std::tie(parameter.option.name, parameter.option.kind);
    if (!given.has(name) && parameter.option.initial.empty()) continue;
    if (kind == Kind::real || kind == Kind::integer) {
      scene.own.emplace_back(name, given.real(name));
    } else {
      scene.own.emplace_back(name, given.text(name));
    }
  }
}

const std::variant<double, std::string>& own_value(const model::Scene& scene,
                                                   std::string_view name) {
  for (const auto& each : scene.own) {
    if (each.first == name) return each.second;
  }
  throw std::logic_error(fmt::format("the scene has no {}", name));
}

bool is_idle(const model::Scene& scene, std::string_view option) {
  bool idle = false;
  for (const auto* choice : choices()) {
    if (choice->option == option) return choice->word_in(scene).empty();
    if (choice->knows(scene, option)) return false;
    for (const auto* effect : choice->effects) idle = idle || effect->knows(option);
  }
  return idle;
}

double own_number(const model::Scene& scene, std::string_view name) {
  return std::get<double>(own_value(scene, name));
}

void make_noise_levels(model::Scene& scene) {
  if (const auto levels = noises().in(scene).levels; levels != nullptr) {
    scene.noise.table = std::make_shared<const model::LevelTable>(levels(scene));
  }
}

model::Parameters parameters_of(const model::Scene& s) {
  model::Parameters all{
      {"mu_s", s.friction.mu_s}, {"mu_d", s.friction.mu_d}, {"drag", s.drag_name}};
  const auto add = [&all](const std::string& name, const auto& value) {
    const bool known = std::any_of(all.begin(), all.end(),
                                   [&name](const auto& each) { return each.first == name; });
    if (!known) all.emplace_back(name, value);
  };
  const auto add_values = [&](const Choice& choice) {
    for (const auto& word : choice.parts(choice.word_in(s))) {
      for (const auto& [name, value] : values_in(choice.of(word), s)) add(name, value);
    }
  };
  const auto add_word = [&](const Choice& choice) {
    const auto& word = choice.word_in(s);
    if (!word.empty() && word != choice.effects.front()->word) {
      add(std::string(choice.option), choice.word_in(s));
    }
  };
  add_values(noises());
  add_word(noises());
  if (!s.friction.symmetric()) {
    add("mu_s_minus", s.friction.mirrored().mu_s);
    add("mu_d_minus", s.friction.mirrored().mu_d);
  }
  add_word(frictions());
  add_values(frictions());
  add_values(drags());
  add("bias", s.bias);
  if (s.force) {
    add("force_file", s.force->file);
    if (s.force->scale != 1) add("force_scale", s.force->scale);
    if (s.force->gravity > 0) add("force_gravity", s.force->gravity);
    if (s.force->constant) add("force_interpolation", std::string("constant"));
    if (s.force->rest > 0) add("force_rest", s.force->rest);
    if (s.force->step > 0) {
      add("sample_layout", std::string("rows"));
      add("sample_step", s.force->step);
    }
  }
  if (s.limits_speed) add("speed_limit", *s.v_max);
  return all;
}

std::vector<model::Derivative> derivatives_of(const model::Scene& s) {
  using model::BranchFriction;
  std::vector<model::Derivative> all{{"mu_d", [](const BranchFriction& here, double v) {
                                        return here.own_mu_d ? 0.0 : -here.friction.share(v);
                                      }}};
  const auto append = [&](const Choice& choice) {
    const auto& own = choice.in(s).derivatives;
    all.insert(all.end(), own.begin(), own.end());
  };
  if (!s.noise.table) append(noises());
  if (s.friction.mu_d_minus) {
    all.push_back({"mu_d_minus", [](const BranchFriction& here, double v) {
                     return here.own_mu_d ? -here.friction.share(v) : 0.0;
                   }});
  }
  append(frictions());
  append(drags());
  return all;
}

std::vector<std::string> heading(const Effect& effect, const model::Scene& scene) {
  if (effect.heading != nullptr) return {effect.heading(scene)};
  std::vector<std::string> parts;
  for (const auto& [name, value] : values_in(effect, scene)) {
    const auto* number = std::get_if<double>(&value);
    parts.push_back(name + " = " +
                    (number != nullptr ? fmt::format("{:g}", *number) : std::get<1>(value)));
  }
  return parts;
}

}  // namespace stickslip::effects
