#include "stickslip/effects/read_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "read_force.hpp"
#include "stickslip/model/effective_friction.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::effects {
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
    if (made || (noisy() && noises().in(scene_).levels == nullptr)) check_mean_force();
    if (made) check_starts();
    if (given_.sound()) (void)complete(drags());  // which looks at the noise
    if (scene_.noise.table && given_.sound()) check_returns();
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
    const double force = scene_.bias + mean, mu_d = force > 0 ? forwards.mu_d : backwards.mu_d;
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

std::string noise_note(const model::Scene& scene) {
  const auto note = noises().in(scene).note;
  return note != nullptr ? note(scene) : "";
}

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
