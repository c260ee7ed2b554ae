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
      report("mu_d", fmt::format("must be in (0, mu_s], and mu_s = {:g}", forwards.mu_s), grows);
    }
    if (!forwards.symmetric() && backwards.mu_d > backwards.mu_s) {
      report(forwards.mu_d_minus ? "mu_d_minus" : "mu_s_minus",
             fmt::format("must keep mu_d_minus in (0, mu_s_minus]; they are {:g} and {:g}",
                         backwards.mu_d, backwards.mu_s),
             grows);
    }
    const double mean = scene_.noise.table ? scene_.noise.table->mean() : 0;
    const double force = scene_.bias + mean, mu_d = force > 0 ? forwards.mu_d : backwards.mu_d;
    if (drag_law_.expression || !scene_.drag.is_none() || std::abs(force) < mu_d) return;
    const auto noise = mean == 0 ? "" : fmt::format("with the mean {:g} of the noise ", mean);
    report("bias",
           fmt::format(
               "{}accelerates a sliding body for ever: without drag, friction mu_d = {:g} alone "
               "opposes it",
               noise, mu_d),
           "take a bias smaller than mu_d, or add drag");
  }

  // The levels that exist, and that on some of them bodies stick and on some they slide.
  void check_table() {
    const auto process = scene_.meant();
    const auto& noise = process.noise;
    const auto range =
        fmt::format("levels, from {:g} to {:g}, shifted by the bias {:g}",
                    noise.level(noise.lowest()), noise.level(noise.highest()), scene_.bias);
    if (process.lowest_static() > process.static_index()) {
      report("mu_s", "holds the body on none of the noise " + range + ": the body never sticks",
             "take a larger -mu_s or another -bias");
    } else if (!process.starts_upwards() && !process.starts_downwards()) {
      report("mu_s", "holds the body on all of the noise " + range + ": the body never slides",
             "take a smaller -mu_s or a larger -bias");
    }
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
      return check_table();
    }
    if (scene_.noise.name != "ou") return;  // reported
    const double delta = scene_.delta,
                 sigma = scene_.noise.deviation.value_or(1 / std::sqrt(scene_.tau)),
                 ratio = delta * delta / (sigma * sigma);
    const bool own = scene_.noise.deviation.has_value();
    const char* stronger = own ? "a larger -noise_deviation" : "smaller -tau";
    int full = 0, highest = 0, lowest = 0;
    try {
      full = scene_.full_levels();
      highest = scene_.process(1).static_index();
      lowest = scene_.process(1).lowest_static();
    } catch (const std::out_of_range&) {
      const bool by_mu_s = settings_.given("delta_per_mu_s");
      return report(by_mu_s ? "delta_per_mu_s" : "delta", "gives more than 2147483647 noise levels",
                    "take a larger step");
    }
    const bool word = settings_.given("noise_levels") && !scene_.noise_levels;
    if (word) scene_.noise_levels = full;
    const int levels = scene_.noise_levels.value_or(full), k = std::max(highest, -lowest);
    const double largest = levels * delta;
    if (full < 1) {
      report_coarse_steps(sigma);
    } else if (levels > full) {
      report(
          "noise_levels",
          fmt::format("gives {} = {:g} with L_X = N delta, but jump probabilities need at most 2",
                      own ? "delta L_X/noise_deviation^2" : "tau delta L_X", ratio * levels),
          fmt::format("take at most {}, or full", full));
    } else if (k >= levels && lowest + highest != 0) {
      const bool backwards = -lowest > highest;
      const auto& friction = scene_.friction;
      const double mu_s = backwards ? friction.mirrored().mu_s : friction.mu_s;
      const bool biased = scene_.bias != 0;
      const char* threshold = backwards && friction.mu_s_minus ? "mu_s_minus" : "mu_s";
      report(biased ? "bias" : threshold,
             fmt::format("is never exceeded by the noise, which is at most {:g}: a body at rest "
                         "never starts towards {} v",
                         largest, backwards ? "negative" : "positive"),
             fmt::format("take {} below {:g}, or {} or -delta",
                         biased ? "|bias|" : fmt::format("-{}", threshold),
                         biased ? largest - mu_s : largest, stronger));
    } else if (k >= levels) {
      const auto why = fmt::format(
          "must be below the largest noise level {:g}: otherwise the body never slides", largest);
      if (levels < full) return report("mu_s", why, fmt::format("take -noise_levels above {}", k));
      report("mu_s", why, fmt::format("take -mu_s below {:g}, or {} or -delta", largest, stronger));
    } else if (lowest > highest) {
      report("mu_s",
             fmt::format("holds the body on no noise level (they are {:g} apart and shifted by the "
                         "bias {:g}): the body never sticks",
                         delta, scene_.bias),
             "take a smaller -delta");
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
