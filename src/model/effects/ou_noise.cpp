#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <new>
#include <stdexcept>

#include "all.hpp"
#include "levels.hpp"

namespace stickslip::effects {

bool make_levels(Given& given, model::Scene& scene, const char* option, const char* fix) {
  if (!given.sound()) return false;
  try {
    make_noise_levels(scene);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& unfit) {  // files have errors of their own
    given.refuse(option, unfit.what(), fix);
  }
  return scene.noise.table != nullptr;
}

States sum(const States& a, const States& b) {
  const std::size_t count = b.x.size();
  require_number_of_states(static_cast<double>(a.x.size()) * static_cast<double>(count));
  States all;
  for (double x : a.x) {
    for (double y : b.x) all.x.push_back(x + y);
  }
  for (const auto& [from, to, rate] : a.transitions) {
    for (std::size_t m = 0; m < count; ++m) {
      all.transitions.push_back({from * count + m, to * count + m, rate});
    }
  }
  for (std::size_t n = 0; n < a.x.size(); ++n) {
    for (const auto& [from, to, rate] : b.transitions) {
      all.transitions.push_back({n * count + from, n * count + to, rate});
    }
  }
  return all;
}

void require_number_of_states(double count) {
  constexpr double most = 4000;  // of which factors take more than ten gigabytes
  if (count <= most) return;
  throw std::invalid_argument(
      fmt::format("gives a chain of {:.0f} states, and at most {:g} are taken", count, most));
}

namespace {

constexpr const char *kSteps = "delta_per_mu_s", *kAmplitude = "telegraph_amplitude",
                     *kRate = "telegraph_rate";

double deviation_of_ou(const model::Scene& scene) {
  return scene.noise.deviation.value_or(1 / std::sqrt(scene.tau));
}

void read_ou(Given& given, model::Scene& scene) {
  scene.tau = given.real(kTau);
  const auto steps = given.integer(kSteps);
  if (steps && given.has(kDelta)) {
    given.refuse(kSteps, "gives the noise step, and so does -delta = " + given.text(kDelta),
                 "leave one of them out");
  }
  // With a spring results of levels are off by the first order of the step.
  const bool tied = given.has(kStiffness) && !given.has(kDelta) && !given.has(kLevels);
  scene.delta = tied ? 0 : given.real(kDelta);
  if (steps) scene.delta = scene.friction.mu_s / *steps;
  scene.noise_levels = given.integer(kLevels);
  if (given.has(kDeviation)) scene.noise.deviation = given.real(kDeviation);
  const double tau = scene.tau, sigma = deviation_of_ou(scene);
  if (given.sound() && scene.delta == 0) {
    if (given.has(kLevels)) {
      return given.refuse(kLevels, "counts levels, and with -delta 0 there are none",
                          "leave it out");
    }
    scene.delta = sigma / 8;  // of the chain that may be taken in its place
    return make_continuous(given, scene, {{sigma * sigma, 1 / tau}}, kTau, "take for example 1");
  }
  scene.noise.target = [=](double omega) {
    return 2 * sigma * sigma * tau / (1 + omega * omega * tau * tau);
  };
}

// Reports a noise step, as -delta or by how many of them go up to mu_s.
void refuse_step(Given& given, const std::string& why, const std::string& steps_fix,
                 const std::string& delta_fix) {
  const bool by_steps = given.has(kSteps);
  given.refuse(by_steps ? kSteps : kDelta, why, by_steps ? steps_fix : delta_fix);
}

void refuse_coarse_steps(Given& given, const model::Scene& scene, double sigma) {
  const double largest = std::sqrt(2) * sigma;
  refuse_step(
      given,
      fmt::format("leaves no noise level besides 0: {} = {:g} must be at most 2",
                  scene.noise.deviation ? fmt::format("(delta/{})^2", kDeviation) : "tau delta^2",
                  std::pow(scene.delta / sigma, 2)),
      fmt::format("take at least {:.0f}", std::ceil(scene.friction.mu_s / largest)),
      fmt::format("take -delta at most {:g}", largest));
}

bool check_levels(Given& given, model::Scene& scene) {
  if (scene.noise.gaussian || !given.sound()) return complete_continuous(given, scene);
  const double delta = scene.delta, sigma = deviation_of_ou(scene),
               ratio = delta * delta / (sigma * sigma);
  int full = 0;
  try {
    full = scene.full_levels();
  } catch (const std::out_of_range&) {
    const bool white = !scene.noise.deviation && scene.tau < 1e-3;
    const std::string limit = white ? "; the limit of small -tau is that of -study tau" : "";
    refuse_step(given, "gives more than 2147483647 noise levels", "take fewer steps" + limit,
                fmt::format("take a larger step, such as {:g}, an eighth of the deviation of the "
                            "noise{}",
                            sigma / 8, limit));
    return false;
  }
  const bool word = given.has(kLevels) && !scene.noise_levels;
  if (word) scene.noise_levels = full;
  const int levels = scene.noise_levels.value_or(full);
  if (full < 1) {
    refuse_coarse_steps(given, scene, sigma);
    return false;
  }
  if (levels > full) {
    given.refuse(
        kLevels,
        fmt::format("gives {} = {:g} with L_X = N delta, but jump probabilities need at most 2",
                    scene.noise.deviation ? fmt::format("delta L_X/{}^2", kDeviation)
                                          : "tau delta L_X",
                    ratio * levels),
        fmt::format("take at most {}, or full", full));
    return false;
  }
  return true;
}

model::Parameters ou_values(const model::Scene& scene) {
  model::Parameters all{{kTau, scene.tau}, {kDelta, scene.noise.gaussian ? 0 : scene.delta}};
  if (scene.noise.deviation) all.emplace_back(kDeviation, *scene.noise.deviation);
  return all;
}

std::string stronger_ou(const model::Scene& scene) {
  return scene.noise.deviation ? fmt::format("a larger -{} or a smaller -delta", kDeviation)
                               : "a smaller -tau or -delta";
}

}  // namespace

Option tau_option() {
  return Option::real(kTau, "time", "1", Range::positive(), "correlation time of -noise ou",
                      "the limit of white noise is that of -study tau",
                      {.symbol = "\\tau",
                       .label = "correlation time of the noise",
                       .slider = Slider{.low = 0.05, .high = 10, .start = 1, .logarithmic = true},
                       .others = {"tau_c", "t_corr", "correlation_time"}});
}

Option deviation_option() {
  return Option::real(
      kDeviation, "force", "", Range::positive(),
      "standard deviation of X. Unless given, it is 1/sqrt(tau) with -noise ou, "
      "with which X tends to white noise of fixed intensity as tau -> 0, and 1 with "
      "-noise narrow_band",
      "take the standard deviation of the measured force",
      {.symbol = "\\sigma",
       .label = "standard deviation of the noise",
       .slider = Slider{.low = 0.1, .high = 5, .logarithmic = true},
       .others = {"sigma", "std", "stddev", "deviation", "intensity", "rms", "D", "noise_intensity",
                  "temperature"}});
}

const Effect kOrnsteinUhlenbeck{
    .word = "ou",
    .sentence = "the chain of the paper, which tends to the Ornstein-Uhlenbeck process as -delta "
                "-> 0",
    .others = {"ornstein_uhlenbeck"},
    .explained = {"white", "white_noise"},
    .page = "-study tau in docs/white_noise.md",
    .parameters =
        {{tau_option()},
         {Option::real(
             kDelta, "force", "0.125", Range::not_negative(),
             "step between neighbouring noise levels; 0: none, the Gaussian noise of continuous "
             "paths. Unless given, half the deviation with -study tau",
             "take for example 0.125, or 0",
             {.symbol = "\\delta", .label = "noise step", .others = {"dx", "step", "noise_step"}})},
         {Option::integer(kSteps, "", Range::whole(1, 1e6),
                          "number n of noise steps up to mu_s, in the place of -delta: delta = "
                          "mu_s/n puts mu_s on a level, so that results are continuous in mu_s",
                          "take for example 8", {},
                          {.symbol = "\\mu_s/\\delta",
                           .label = "noise steps up to static friction",
                           .slider = Slider{.low = 1, .high = 32, .start = 8}}),
          true},
         {Option::integer(
             kLevels, "", Range::whole(1, 1e9),
             "number N of noise levels on each side of 0; `full` is the largest "
             "possible, 2 (deviation/delta)^2. Unless given, the noise is that of "
             "full, truncated where -accuracy allows it",
             kChosen, {"full"},
             {.symbol = "N", .label = "noise levels on each side", .others = {"levels"}})},
         {deviation_option()}},
    .read = read_ou,
    .complete = check_levels,
    .values = ou_values,
    .derivatives = {{kTau}},
    .stronger = stronger_ou};

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
    .complete =
        [](Given& given, model::Scene& scene) {
          return make_levels(given, scene, kRate,
                             "take for example -telegraph_amplitude 1 -telegraph_rate 1");
        },
    .levels =
        [](const model::Scene& scene) {
          const double a = own_number(scene, kAmplitude), rate = own_number(scene, kRate);
          return model::LevelTable({{-a, rate, 0}, {a, 0, rate}});
        },
    .heading =
        [](const model::Scene& scene) {
          return fmt::format("telegraph noise a = {:g}, rate = {:g}", own_number(scene, kAmplitude),
                             own_number(scene, kRate));
        }};

}  // namespace stickslip::effects
