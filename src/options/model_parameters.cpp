#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "reading.hpp"
#include "stickslip/model/drag_law.hpp"
#include "stickslip/model/effective_friction.hpp"
#include "stickslip/support/text.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

/// Reads the parameters of the model one after the other, as far as they make sense.
class SceneReader {
 public:
  SceneReader(const Settings& settings, Problems& problems)
      : settings_(settings), problems_(problems) {}

  model::Scene read() {
    read_numbers();
    check_friction();
    check_noise();
    if (drag_law_.expression && problems_.empty()) read_expression();  // which looks at the noise
    if (scene_.noise.table && problems_.empty()) check_returns();
    return scene_;
  }

 private:
  void report(const char* option, const std::string& why, const std::string& fix) {
    settings_.report(problems_, option, why, fix);
  }

  void read_numbers() {
    scene_.tau = settings_.real("tau");
    scene_.friction = {settings_.real("mu_s"), settings_.real("mu_d")};
    const auto steps = settings_.integer("delta_per_mu_s");
    scene_.delta = steps ? scene_.friction.mu_s / *steps : settings_.real("delta");
    read_noise();
    const auto by_direction = [this](const char* option) {
      return settings_.given(option) ? std::optional(settings_.real(option)) : std::nullopt;
    };
    scene_.friction.mu_s_minus = by_direction("mu_s_minus");
    scene_.friction.mu_d_minus = by_direction("mu_d_minus");
    if (meaning(kFrictionLaws, settings_.text("friction"))) read_stribeck();
    scene_.drag_name = settings_.text("drag");
    scene_.drag = {drag_law_.linear ? settings_.real("drag_coefficient") : 0,
                   drag_law_.cubic ? settings_.real("drag_cubic") : 0};
    if (drag_law_.expression) scene_.drag_expression = settings_.text("drag_expression");
    scene_.bias = settings_.real("bias");
    scene_.noise_levels = settings_.integer("noise_levels");
    if (settings_.given("v_max")) scene_.v_max = settings_.real("v_max");
    scene_.limits_speed = settings_.given("speed_limit");
    if (scene_.limits_speed) scene_.v_max = settings_.real("speed_limit");
  }

  void read_noise() {
    auto& noise = scene_.noise;
    noise.name = settings_.text("noise");
    if (noise.name == "telegraph") {
      if (!has("telegraph_amplitude", "1") || !has("telegraph_rate", "1")) return;
      const double a = noise.amplitude = settings_.real("telegraph_amplitude"),
                   rate = noise.rate = settings_.real("telegraph_rate");
      set_levels("telegraph_rate", "take for example -telegraph_amplitude 1 -telegraph_rate 1",
                 [=] {
                   return model::LevelTable({{-a, rate, 0}, {a, 0, rate}});
                 });
    } else if (noise.name == "file" && has("noise_file", "levels.csv")) {
      noise.file = settings_.text("noise_file");
      set_levels("noise_file", "write CSV with the columns x,rate_up,rate_down, x rising",
                 [&noise] { return read_levels(noise.file); });
    } else if (settings_.given("noise_deviation")) {
      noise.deviation = settings_.real("noise_deviation");
    }
  }

  bool has(const char* option, const char* example) {
    if (settings_.given(option)) return true;
    report("noise", fmt::format("needs -{}", option),
           fmt::format("add for example -{} {}", option, example));
    return false;
  }

  template <class Levels>
  void set_levels(const char* option, const char* fix, Levels levels) {
    if (!problems_.empty()) return;  // the numbers may be without meaning
    try {
      scene_.noise.table = std::make_shared<const model::LevelTable>(levels());
    } catch (const std::invalid_argument& unfit) {
      report(option, unfit.what(), fix);
    }
  }

  void read_stribeck() {
    const char* velocity = "stribeck_velocity";
    if (settings_.given(velocity)) {
      scene_.friction.stribeck = {settings_.real(velocity), settings_.real("stribeck_exponent")};
    } else {
      report("friction", "needs a -stribeck_velocity", "add for example -stribeck_velocity 0.1");
    }
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
    const double mean = scene_.noise.table ? scene_.noise.table->mean() : 0;
    const double force = scene_.bias + mean, mu_d = force > 0 ? forwards.mu_d : backwards.mu_d;
    if (drag_law_.expression || !scene_.drag.is_none() || std::abs(force) < mu_d) return;
    if (force == 0) {
      return report("mu_d", "leaves nothing that slows a body: there is no drag either",
                    "take a positive -mu_d, or add drag");
    }
    const auto noise = mean == 0 ? "" : fmt::format("with the mean {:g} of the noise ", mean);
    report("bias",
           fmt::format(
               "{}accelerates a sliding body for ever: without drag, friction mu_d = {:g} alone "
               "opposes it",
               noise, mu_d),
           "take a bias smaller than mu_d, or add drag");
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
      const int k = std::min(all.static_index(), -all.lowest_static());
      if (k < scene_.full_levels()) {
        return report(threshold, why, fmt::format("take -noise_levels above {}", k));
      }
    }
    const char* stronger = scene_.noise.name != "ou" ? "a stronger noise"
                           : scene_.noise.deviation
                               ? "a larger -noise_deviation or a smaller -delta"
                               : "a smaller -tau or -delta";
    report(threshold, why,
           most > 0 ? fmt::format("take -{} below {:g}, or {}", threshold, most, stronger)
                    : fmt::format("take {}", stronger));
  }

  // No level besides 0.
  void report_coarse_steps(double sigma) {
    const double largest = std::sqrt(2) * sigma;
    const bool by_mu_s = settings_.given("delta_per_mu_s");
    report(by_mu_s ? "delta_per_mu_s" : "delta",
           fmt::format("leaves no noise level besides 0: {} = {:g} must be at most 2",
                       scene_.noise.deviation ? "(delta/noise_deviation)^2" : "tau delta^2",
                       std::pow(scene_.delta / sigma, 2)),
           by_mu_s ? fmt::format("take at least {:.0f}", std::ceil(scene_.friction.mu_s / largest))
                   : fmt::format("take -delta at most {:g}", largest));
  }

  void check_noise() {
    if (scene_.noise.table) {
      scene_.noise_levels.reset();
      return check_starts();
    }
    if (scene_.noise.name != "ou") return;  // reported
    const double delta = scene_.delta,
                 sigma = scene_.noise.deviation.value_or(1 / std::sqrt(scene_.tau)),
                 ratio = delta * delta / (sigma * sigma);
    const bool own = scene_.noise.deviation.has_value();
    int full = 0;
    try {
      full = scene_.full_levels();
    } catch (const std::out_of_range&) {
      const bool by_mu_s = settings_.given("delta_per_mu_s");
      return report(by_mu_s ? "delta_per_mu_s" : "delta", "gives more than 2147483647 noise levels",
                    "take a larger step");
    }
    const bool word = settings_.given("noise_levels") && !scene_.noise_levels;
    if (word) scene_.noise_levels = full;
    const int levels = scene_.noise_levels.value_or(full);
    if (full < 1) {
      report_coarse_steps(sigma);
    } else if (levels > full) {
      report(
          "noise_levels",
          fmt::format("gives {} = {:g} with L_X = N delta, but jump probabilities need at most 2",
                      own ? "delta L_X/noise_deviation^2" : "tau delta L_X", ratio * levels),
          fmt::format("take at most {}, or full", full));
    } else {
      check_starts();
    }
  }

  // On the lowest level bodies must come to rest from every velocity that they reach: otherwise
  // some slide for ever.
  void check_returns() {
    const auto process = scene_.meant();
    for (const auto& branch : {process, process.mirrored()}) {
      const auto& noise = branch.noise;
      const double lowest = branch.net_force(noise.lowest()),
                   highest = branch.net_force(noise.highest());
      const double rise = branch.drag.highest(branch.drag.terminal_velocity(highest));
      if (!branch.starts_upwards() || lowest + rise < 0) continue;
      return report(
          "mu_d",
          fmt::format("does not stop sliding bodies: on the outermost noise level, {:g} from the "
                      "mean, a force of {:g} still accelerates them",
                      noise.level(noise.lowest()) - noise.mean(), lowest + rise),
          "take a larger -mu_d, or levels on both sides of it");
    }
  }

  void read_expression() {
    if (scene_.drag_expression.empty()) {
      return report("drag", "needs a formula in -drag_expression",
                    "add for example -drag_expression \"-v - 0.1*v*abs(v)\"");
    }
    const auto process = scene_.meant();
    try {
      scene_.drag = model::parse_drag(
          scene_.drag_expression, scene_.friction, scene_.tau, largest_force(scene_),
          process.mean_force(),
          std::max(process.noise.tail_intensity(), process.mirrored().noise.tail_intensity()));
    } catch (const model::UnfitLaw& unfit) {
      report("drag_expression", unfit.what(), unfit.fix());
    }
  }

  const Settings& settings_;
  Problems& problems_;
  const DragLaw drag_law_ = meaning(kDragLaws, settings_.text("drag"));
  model::Scene scene_;
};

}  // namespace

double largest_force(const model::Scene& scene) {
  const auto process = scene.meant();
  const auto& noise = process.noise;
  const double highest = std::max(noise.level(noise.highest()), -noise.level(noise.lowest()));
  const auto &along = scene.friction, against = along.mirrored();
  const double seen =
      std::max(along.mu_s, against.mu_s) + noise.step() + 12 * noise.standard_deviation();
  return std::min(highest, noise.table ? highest : seen) + std::abs(scene.bias) -
         std::min(along.mu_d, against.mu_d);
}

model::Scene read_scene(const Settings& settings, Problems& problems) {
  return SceneReader(settings, problems).read();
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

}  // namespace stickslip::options
