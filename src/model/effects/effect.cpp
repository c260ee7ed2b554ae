#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "all.hpp"
#include "levels.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::effects {

bool Range::contains(double value) const {
  return (low_included ? value >= low : value > low) &&
         (high_included ? value <= high : value < high);
}

std::string Range::text() const {
  return fmt::format("{}{:g}, {:g}{}", low_included ? '[' : '(', low, high,
                     high_included ? ']' : ')');
}

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
  return std::ranges::any_of(parameters, [&](const auto& p) { return p.option.name == option; });
}

const Effect& Choice::of(std::string_view word) const {
  static const Effect nothing{};
  if (word.empty()) return nothing;
  if (sum != nullptr && word.find('+') != std::string_view::npos) return *sum;
  const auto found = std::ranges::find(effects, word, &Effect::word);
  return found != effects.end() ? **found : *effects.front();
}

std::vector<std::string> Choice::parts(const std::string& word) const {
  return sum != nullptr ? split(word, '+') : std::vector{word};
}

std::vector<const Effect*> Choice::all_in(const model::Scene& scene) const {
  std::vector<const Effect*> all;
  for (const auto& word : parts(word_in(scene))) all.push_back(&of(word));
  return all;
}

bool Choice::knows(const model::Scene& scene, std::string_view name) const {
  return std::ranges::any_of(all_in(scene),
                             [&](const auto* effect) { return effect->knows(name); });
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
    const auto known = std::ranges::find(all, name, &model::Parameters::value_type::first);
    if (known == all.end()) all.emplace_back(name, value);
  };
  const auto add_values = [&](const Choice& choice) {
    for (const auto* effect : choice.all_in(s)) {
      for (const auto& [name, value] : values_in(*effect, s)) add(name, value);
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
  if (s.stiffness > 0) add(kStiffness, s.stiffness);
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
  if (!s.noise.gaussian) return all;
  const auto by_nodes = [&all](std::string_view option) {
    if (std::ranges::find(all, option, &model::Derivative::option) != all.end()) return;
    all.push_back({model_option(option).name, [](const BranchFriction&, double) { return 0.0; }});
  };
  by_nodes("mu_s");
  if (s.friction.mu_s_minus) by_nodes("mu_s_minus");
  for (const auto& [name, value] : parameters_of(s)) {
    const bool follows = is_given_by_another(s, name);
    if (std::holds_alternative<double>(value) && noises().knows(s, name) && !follows)
      by_nodes(name);
  }
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
      const bool declared = std::ranges::find(options, name, &Option::name) != options.end();
      if (!declared) options.push_back(parameter.option);
    }
  }
}

// What acts on the body beside noise, friction and drag, and what bounds its speed.
std::vector<Option> options_of_the_body() {
  return {
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
          kStiffness, "1/time^2", "", Range::positive(),
          "stiffness K of a spring that pulls the body at p back by -K p, dp/dt = v, per unit "
          "mass. "
          "Under -noise ou without -delta, or with -delta 0, the noise is the continuous one",
          "leave it out for a body without a spring",
          {.symbol = "K",
           .label = "stiffness of the spring",
           .slider = Slider{.low = 0.1, .high = 25, .logarithmic = true},
           .others = {"K", "k", "spring", "stiffness", "spring_constant", "restoring_force",
                      "trap"},
           .page = "docs/spring.md"}),
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
  for (const auto& others : {force_options(), options_of_the_body()})
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

namespace {

/// Reads the parameters of the model one after the other, as far as they make sense.
class SceneReader {
 public:
  SceneReader(Given& given, Drive drive) : given_(given), drive_(drive) {}

  model::Scene read() {
    read_numbers();
    if (drive_ != Drive::noise) read_force(given_, scene_);
    if (!noisy()) scene_.noise.name.clear();
    for (const auto* choice : choices()) {
      const std::string word = choice->word_in(scene_);
      read_effect(given_, *choice, word, scene_);
    }
    check_friction();
    const bool made = noisy() && complete(noises());
    const bool tied = given_.has(kStiffness);
    if (made || (noisy() && noises().in(scene_).levels == nullptr)) check_mean_force();
    if (made && !tied) check_starts();
    if (given_.sound()) (void)complete(drags());  // which looks at the noise
    if (given_.has(kStiffness)) {
      read_spring(given_, scene_);
    } else if (scene_.noise.table && given_.sound()) {
      check_returns();
    }
    return scene_;
  }

 private:
  [[nodiscard]] bool noisy() const { return drive_ != Drive::given_force; }

  void report(const char* option, const std::string& why, const std::string& fix) {
    given_.refuse(option, why, fix);
  }

  void read_numbers() {
    auto& friction = scene_.friction;
    friction = {given_.real("mu_s"), given_.real("mu_d")};
    const auto by_direction = [this](const char* option) {
      return given_.has(option) ? std::optional(given_.real(option)) : std::nullopt;
    };
    friction.mu_s_minus = by_direction("mu_s_minus");
    friction.mu_d_minus = by_direction("mu_d_minus");
    if (!given_.has("mu_d")) {
      const double usual = friction.mu_d;
      friction.mu_d = std::min(usual, friction.mu_s);
      const double least = friction.mu_s_minus.value_or(friction.mu_s);
      if (!friction.mu_d_minus && least != friction.mu_s) {
        friction.mu_d_minus = std::min(usual, least);
      }
    }
    scene_.friction_name = given_.text("friction");
    scene_.noise.name = given_.text("noise");
    scene_.drag_name = given_.text("drag");
    scene_.bias = given_.real("bias");
    if (given_.has("v_max")) scene_.v_max = given_.real("v_max");
    scene_.limits_speed = given_.has("speed_limit");
    if (scene_.limits_speed) scene_.v_max = given_.real("speed_limit");
  }

  // Whether the scene is as the effect needs it.
  bool complete(const Choice& choice) {
    const auto& effect = choice.in(scene_);
    return effect.complete == nullptr || effect.complete(given_, scene_);
  }

  void check_friction() {
    const auto& forwards = scene_.friction;
    const auto backwards = forwards.mirrored();
    const char* grows = "dynamic friction cannot exceed static friction";
    if (forwards.mu_d > forwards.mu_s) {
      report("mu_d", fmt::format("must be in [0, mu_s], and mu_s = {:g}", forwards.mu_s), grows);
    }
    if (!forwards.symmetric() && backwards.mu_d > backwards.mu_s) {
      report(forwards.mu_d_minus ? "mu_d_minus" : "mu_s_minus",
             fmt::format("must keep mu_d_minus in [0, mu_s_minus]; they are {:g} and {:g}",
                         backwards.mu_d, backwards.mu_s),
             grows);
    }
  }

  // Without drag, friction alone opposes what drives bodies over long times. A drag of a formula is
  // judged where it is read.
  void check_mean_force() {
    const auto& forwards = scene_.friction;
    const auto backwards = forwards.mirrored();
    const double mean = scene_.noise.table ? scene_.noise.table->mean() : 0;
    const double driving = scene_.bias + mean, force = given_.has(kStiffness) ? 0 : driving,
                 mu_d = force > 0 ? forwards.mu_d : backwards.mu_d;
    const bool made_later = drags().in(scene_).complete != nullptr;
    if (made_later || !scene_.drag.is_none() || std::abs(force) < mu_d) return;
    if (force == 0) {
      return report("mu_d", "leaves nothing that slows a body: there is no drag either",
                    "take a positive -mu_d, or add drag");
    }
    const char* of_side = force < 0 && forwards.mu_d_minus ? "mu_d_minus" : "mu_d";
    const auto noise = mean == 0 ? "" : fmt::format("with the mean {:g} of the noise ", mean);
    if (scene_.bias != 0) {
      return report("bias",
                    fmt::format("{}accelerates a sliding body for ever: without drag, friction "
                                "{} = {:g} alone opposes it",
                                noise, of_side, mu_d),
                    ways_to_hold(force, mean));
    }
    report(of_side,
           fmt::format("does not hold the mean {:g} of the noise, which accelerates a sliding body "
                       "for ever: without drag, friction alone opposes it",
                       mean),
           ways_to_hold(force, mean));
  }

  // What makes friction stronger than the mean force, or drag bound the speed.
  [[nodiscard]] std::string ways_to_hold(double force, double mean) const {
    const auto& forwards = scene_.friction;
    const auto backwards = forwards.mirrored();
    std::vector<std::string> ways{"add drag, such as -drag linear"};
    model::Scene balanced = scene_;
    const auto bias = fmt::format("{:g}", (forwards.mu_d - backwards.mu_d) / 2 - mean);
    balanced.bias = std::stod(bias);
    const auto process = balanced.meant();
    const double left = process.mean_force();
    const bool held = -backwards.mu_d < left && left < forwards.mu_d;
    const bool moves = process.starts_upwards() || process.starts_downwards();
    if (held && moves && process.sticks()) {
      ways.push_back(mean == 0 ? "take a bias smaller than mu_d" : "take -bias " + bias);
    }
    if (std::abs(force) < (force > 0 ? forwards : backwards).mu_s) {
      ways.push_back(fmt::format("take a larger -mu_d, above {:g}", std::abs(force)));
    }
    return enumerate(ways, "or");
  }

  // That there is a level on which bodies slide. Where there is none on which they stick, what asks
  // for sticking phases is refused elsewhere.
  void check_starts() {
    const auto process = scene_.meant();
    const auto& noise = process.noise;
    if (process.starts_upwards() || process.starts_downwards()) return;
    const double lowest = noise.level(noise.lowest()), highest = noise.level(noise.highest());
    const auto backwards = scene_.friction.mirrored();
    const bool upwards =
        highest + scene_.bias - scene_.friction.mu_s >= -lowest - scene_.bias - backwards.mu_s;
    const double most = upwards ? highest + scene_.bias : -lowest - scene_.bias;
    const char* threshold = upwards || !scene_.friction.mu_s_minus ? "mu_s" : "mu_s_minus";
    const auto why = fmt::format(
        "holds the body on all of the noise levels, from {:g} to {:g}, {}: the body never slides, "
        "P_stick = 1 and V = 0",
        lowest, highest,
        scene_.bias == 0 ? "whichever occurs"
                         : fmt::format("shifted by the bias {:g}", scene_.bias));
    if (scene_.noise_levels && *scene_.noise_levels < scene_.full_levels()) {
      const auto all = scene_.process(scene_.full_levels());
      const int k = std::min(all.highest_static(), -all.lowest_static());
      if (k < scene_.full_levels()) {
        return report(threshold, why, fmt::format("take -noise_levels above {}", k));
      }
    }
    const auto& made_by = noises().in(scene_);
    const auto stronger =
        made_by.stronger != nullptr ? made_by.stronger(scene_) : std::string("a stronger noise");
    report(threshold, why,
           most > 0 ? fmt::format("take -{} below {:g}, or {}", threshold, most, stronger)
                    : fmt::format("take {}", stronger));
  }

  // On the lowest level bodies that ever stick must come to rest from every velocity that they
  // reach: otherwise some slide for ever.
  void check_returns() {
    const auto process = scene_.meant();
    for (const auto& branch : {process, process.mirrored()}) {
      const auto& noise = branch.noise;
      const double lowest = branch.net_force(noise.lowest()),
                   highest = branch.net_force(noise.highest());
      const double rise = branch.drag.highest(branch.drag.terminal_velocity(highest));
      if (!branch.starts_upwards() || lowest + rise < 0) continue;
      if (!process.sticks() && branch.moves_on()) continue;
      return report(
          "mu_d",
          fmt::format("does not stop sliding bodies: on the outermost noise level, {:g} from the "
                      "mean, a force of {:g} still accelerates them",
                      noise.level(noise.lowest()) - noise.mean(), lowest + rise),
          lowest < 0 ? "take a larger -mu_d, or levels on both sides of it"
                     : fmt::format("take a static coefficient as small as mu_d for the motion that "
                                   "goes on, or a larger -mu_d, above {:g}",
                                   lowest + branch.friction.at_rest()));
    }
  }

  Given& given_;
  Drive drive_;
  model::Scene scene_;
};

}  // namespace

model::Scene read_scene(Given& given, Drive drive) { return SceneReader(given, drive).read(); }

std::string step_warning(const model::Scene& scene) {
  std::vector<std::string> acting;
  for (bool backwards : {false, true}) {
    const auto effective = model::effective_mu_s(scene, backwards);
    if (!effective || (backwards && scene.symmetric())) continue;
    acting.push_back(fmt::format("mu_s{} = {:g} acts as {:g}", backwards ? "_minus" : "",
                                 backwards ? scene.friction.mirrored().mu_s : scene.friction.mu_s,
                                 *effective));
  }
  if (acting.empty()) return "";
  const std::string fix =
      scene.symmetric()
          ? fmt::format("-delta_per_mu_s {:.0f} in the place of -delta puts mu_s on a level",
                        std::max(1.0, std::round(scene.friction.mu_s / scene.delta)))
          : "take a -delta of which mu_s - bias and mu_s_minus + bias are multiples";
  return fmt::format(
      "{} on bodies at rest, which stick on noise levels up to it, and these are {:g} apart; {}",
      enumerate(acting, "and"), scene.delta, fix);
}

}  // namespace stickslip::effects
