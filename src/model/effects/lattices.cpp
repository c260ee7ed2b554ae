#include <boost/math/tools/minima.hpp>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "all.hpp"
#include "levels.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::effects {

// Gaussian noises of two states, the force and a second one; with -delta as chains on a lattice.

inline constexpr const char* kRadius = "noise_radius";
[[nodiscard]] Option radius_option();

/// Stationary Gaussian noise with the covariance deviation^2 exp(-decay t) (cos(frequency t) + sine
/// sin(frequency t)), decay >= sine frequency.
struct PlaneNoise {
  double deviation;         ///< [force]
  double decay, frequency;  ///< [1/time]
  double sine = 0;
};

/// Reads the options of its own, which are numbers, and the deviation, if it is given. With -delta
/// or -noise_radius the noise is put on a lattice; unless given, the step is then about half the
/// deviation, with mu_s halfway between two levels.
void read_plane(Given& given, model::Scene& scene, std::initializer_list<const char*> own,
                double deviation, PlaneNoise (*noise)(const model::Scene&));

/// What the effects of lattices have in common: Effect::complete, values and stronger.
[[nodiscard]] bool complete_lattice(Given& given, model::Scene& scene);
[[nodiscard]] model::Parameters lattice_values(const model::Scene& scene);
[[nodiscard]] std::string stronger_lattice(const model::Scene& scene);

/// The noise of a scene on the points x = i step, i whole, and multiples of a second step across,
/// within -noise_radius standard deviations. Each coordinate jumps to its neighbours, at rates that
/// give its drift and its diffusion where both are positive (second order in the step). Elsewhere
/// it jumps along the drift alone, which diffuses more (first order).
///
/// The covariance fixes the law of the force, but leaves the variance of the second coordinate
/// open. It is the one for which the jumps are of second order on the largest part of the plane.
/// Throws std::invalid_argument where that is too many states.
[[nodiscard]] model::LevelTable lattice_of(const PlaneNoise& noise, const model::Scene& scene);

/// What the lattice of a scene has in the place of the covariance that is meant; empty where that
/// is no percent.
[[nodiscard]] std::string lattice_note(const model::Scene& scene, const PlaneNoise& noise);

namespace {

using Matrix = std::array<std::array<double, 2>, 2>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j];
  }
  return c;
}

Matrix transposed(const Matrix& a) { return {{{a[0][0], a[1][0]}, {a[0][1], a[1][1]}}}; }

/// dz = drift z dt + noise whose covariance is diag(diffusion) dt; z_1 is the force over its
/// deviation, z_2 has the variance 1 as well.
struct Plane {
  Matrix drift, covariance;
  std::array<double, 2> diffusion;
};

// With the rotation A = ((-decay, -frequency), (frequency, -decay)) and the stationary covariance
// P, the noise has the covariance D = -(A P + P A^T). P_11 = 1 and P_12 = -sine give the covariance
// of z_1; then a shear takes what D has off its diagonal away.
Plane plane_of(const PlaneNoise& noise, double second_variance) {
  const Matrix a{{{-noise.decay, -noise.frequency}, {noise.frequency, -noise.decay}}},
      p{{{1, -noise.sine}, {-noise.sine, second_variance}}};
  const Matrix ap = product(a, p);
  const double d11 = -2 * ap[0][0], d12 = -ap[0][1] - ap[1][0], d22 = -2 * ap[1][1],
               shear = d12 / d11, variance = p[1][1] - shear * (2 * p[0][1] - shear),
               scale = 1 / std::sqrt(variance);
  const Matrix to{{{1, 0}, {-shear * scale, scale}}}, back{{{1, 0}, {shear, 1 / scale}}};
  return {product(product(to, a), back),
          product(product(to, p), transposed(to)),
          {d11, (d22 - shear * d12) * scale * scale}};
}

// The second step over the first, both in deviations.
double ratio_of(const Plane& plane) { return std::sqrt(plane.diffusion[1] / plane.diffusion[0]); }

// Jumps are of second order where |drift| step <= diffusion in both coordinates: the smaller of
// both diffusions over the root mean squares of the drifts, for a first step of 1.
double reach(const Plane& plane) {
  const Matrix drifts = product(product(plane.drift, plane.covariance), transposed(plane.drift));
  return std::min(plane.diffusion[0] / std::sqrt(drifts[0][0]),
                  plane.diffusion[1] / (std::sqrt(drifts[1][1]) * ratio_of(plane)));
}

// The second variances for which the noise can be: its determinant is a parabola in them.
Plane best_plane(const PlaneNoise& noise) {
  const double decay = noise.decay, frequency = noise.frequency, p12 = -noise.sine,
               d11 = 2 * (decay - frequency * noise.sine),
               middle = 1 + (decay * d11 / frequency - 2 * decay * p12) / frequency,
               d12 = 2 * decay * p12 + frequency * (middle - 1),
               most = d11 * (2 * decay * middle - 2 * frequency * p12) - d12 * d12,
               width = std::sqrt(most) / frequency;
  constexpr int bits = 30;
  const auto found = boost::math::tools::brent_find_minima(
      [&noise](double variance) { return -reach(plane_of(noise, variance)); },
      middle - width * (1 - 1e-9), middle + width * (1 - 1e-9), bits);
  // To few digits, so that the chain does not depend on rounding.
  constexpr double digits = 1e6;
  return plane_of(noise, std::round(found.first * digits) / digits);
}

// The rate of the jump along a coordinate in a direction, for a drift and a diffusion.
double rate(double drift, double diffusion, double step, int direction) {
  const double along = direction * drift / (2 * step), spread = diffusion / (2 * step * step);
  if (spread >= std::abs(along)) return spread + along;
  return along > 0 ? 2 * along : 0;
}

/// A lattice with the diffusion that each of its states has beyond the one that is meant, summed
/// over the coordinates and over the sum of their diffusions.
struct Lattice {
  States states;
  std::vector<double> added;
};

// Without the states that are never reached: at the rim, where jumps go along the drift alone, some
// are only left.
Lattice pruned(const Lattice& all, std::size_t middle) {
  const auto reached = model::reached_from(middle, all.states.x.size(), all.states.transitions);
  Lattice lattice;
  std::vector<std::size_t> number;
  for (std::size_t n = 0; n < reached.size(); ++n) {
    number.push_back(lattice.added.size());
    if (!reached[n]) continue;
    lattice.states.x.push_back(all.states.x[n]);
    lattice.added.push_back(all.added[n]);
  }
  for (const auto& [from, to, rate] : all.states.transitions) {
    if (reached[from]) lattice.states.transitions.push_back({number[from], number[to], rate});
  }
  return lattice;
}

Lattice made(const PlaneNoise& noise, double step, double radius) {
  const Plane plane = best_plane(noise);
  const auto& p = plane.covariance;
  const double determinant = p[0][0] * p[1][1] - p[0][1] * p[1][0];
  const std::array<double, 2> steps{step / noise.deviation,
                                    step / noise.deviation * ratio_of(plane)};
  require_number_of_states(std::numbers::pi * radius * radius * std::sqrt(determinant) /
                           (steps[0] * steps[1]));
  const auto most = [&](int along) { return static_cast<int>(radius / steps[along] * (1 + 1e-9)); };
  Lattice lattice;
  std::vector<std::pair<int, int>> points;
  std::map<std::pair<int, int>, std::size_t> number;
  for (int i = -most(0); i <= most(0); ++i) {
    for (int j = -most(1); j <= most(1); ++j) {
      const double x = i * steps[0], y = j * steps[1];
      const double square = (p[1][1] * x * x - 2 * p[0][1] * x * y + p[0][0] * y * y) / determinant;
      if (square > radius * radius * (1 + 1e-9)) continue;
      number.emplace(std::pair(i, j), points.size());
      points.emplace_back(i, j);
      lattice.states.x.push_back(i * step);
    }
  }
  const double diffusion = plane.diffusion[0] + plane.diffusion[1];
  for (std::size_t from = 0; from < points.size(); ++from) {
    const auto [i, j] = points[from];
    double added = 0;
    for (int along : {0, 1}) {
      const auto& row = plane.drift[along];
      const double drift = row[0] * i * steps[0] + row[1] * j * steps[1],
                   beyond = std::abs(drift) * steps[along] - plane.diffusion[along];
      added += std::max(beyond, 0.0) / diffusion;
      for (int direction : {-1, 1}) {
        const auto to =
            number.find(along == 0 ? std::pair(i + direction, j) : std::pair(i, j + direction));
        const double r = rate(drift, plane.diffusion[along], steps[along], direction);
        if (to != number.end() && r > 0)
          lattice.states.transitions.push_back({from, to->second, r});
      }
    }
    lattice.added.push_back(added);
  }
  return pruned(lattice, number.at({0, 0}));
}

}  // namespace

Option radius_option() {
  return Option::real(kRadius, "", "4", {1, 10, true, true},
                      "radius of the lattices of -noise narrow_band and filtered, in standard "
                      "deviations",
                      "take for example 4",
                      {.symbol = "R", .label = "radius of the noise lattice"});
}

void read_plane(Given& given, model::Scene& scene, std::initializer_list<const char*> own,
                double deviation, PlaneNoise (*noise)(const model::Scene&)) {
  scene.noise.deviation = given.has(kDeviation) ? given.real(kDeviation) : deviation;
  const double mu_s = scene.friction.mu_s, half = *scene.noise.deviation / 2,
               places = std::round(mu_s / half - 0.5);
  scene.delta = places >= 1 ? mu_s / (places + 0.5) : half;
  for (const char* name : own) scene.own.emplace_back(name, given.real(name));
  const bool by_step = given.has(kDelta) && given.real(kDelta) > 0;
  if (by_step) scene.delta = given.real(kDelta);
  if (!given.sound()) return;
  const auto [sigma, decay, frequency, sine] = noise(scene);
  const std::vector<model::CovarianceTerm> terms{{sigma * sigma, decay, frequency, sine}};
  if (!by_step && !given.has(kRadius)) {
    const char* damping = own.begin()[1];
    return make_continuous(given, scene, terms, damping,
                           fmt::format("take a larger -{}, or give -{}, such as {:.3g}, for a "
                                       "lattice",
                                       damping, kDelta, scene.delta));
  }
  scene.own.emplace_back(kRadius, given.real(kRadius));
  scene.noise.target = [terms](double omega) {
    return model::power_spectral_density(terms, omega);
  };
}

model::Parameters lattice_values(const model::Scene& scene) {
  model::Parameters all{{kDeviation, *scene.noise.deviation}};
  if (!scene.noise.gaussian) all.emplace_back(kDelta, scene.delta);
  return all;
}

model::LevelTable lattice_of(const PlaneNoise& noise, const model::Scene& scene) {
  return made(noise, scene.delta, own_number(scene, kRadius)).states.table();
}

bool complete_lattice(Given& given, model::Scene& scene) {
  if (scene.noise.gaussian) return complete_continuous(given, scene);
  return make_levels(given, scene, given.has(kDelta) ? kDelta : kRadius,
                     "a smaller -delta or a larger -noise_radius makes more states, a larger "
                     "-delta or a smaller -noise_radius fewer");
}

std::string stronger_lattice(const model::Scene&) {
  return fmt::format("a larger -{}", kDeviation);
}

std::string lattice_note(const model::Scene& scene, const PlaneNoise& noise) {
  if (scene.noise.gaussian) return "";
  const auto lattice = made(noise, scene.delta, own_number(scene, kRadius));
  const auto& table = *scene.noise.table;
  const auto probability = model::stationary_distribution(scene.meant().noise);
  double added = 0, one_sided = 0;
  for (int level = table.lowest(); level <= table.highest(); ++level) {
    const double here = probability[static_cast<std::size_t>(level - table.lowest())],
                 more = lattice.added[table.listed(level)];
    added += here * more;
    if (more > 0) one_sided += here;
  }
  const double deviation = std::sqrt(table.variance());
  constexpr double percent = 0.01;
  if (added < percent && std::abs(deviation / noise.deviation - 1) < percent) return "";
  return fmt::format(
      "the chain of -noise {} has {} states and the standard deviation {:.4g} in the place of "
      "{:g}: "
      "jumps along the drift alone, on states that hold {:.2g} % of the probability, add {:.2g} % "
      "to "
      "its diffusion; that falls with -delta, now {:g}, and without -delta there is no lattice",
      scene.noise.name, lattice.added.size(), deviation, noise.deviation, 100 * one_sided,
      100 * added, scene.delta);
}

namespace {

constexpr const char *kGroundFrequency = "ground_frequency", *kGroundDamping = "ground_damping",
                     *kGroundIntensity = "ground_intensity";

// White noise of spectrum S at the foot of an oscillator, q'' + 2 zeta w q' + w^2 q = -noise, gives
// its mass the acceleration X = 2 zeta w q' + w^2 q, of which the spectrum is
//
//   S (1 + (2 zeta r)^2)/((1 - r^2)^2 + (2 zeta r)^2),  r = omega/w,
//
// and the covariance deviation^2 exp(-zeta w t) (cos(nu t) + k sin(nu t)), nu = w (1 - zeta^2)^1/2.
PlaneNoise ground_of(const model::Scene& scene) {
  const double w = own_number(scene, kGroundFrequency), zeta = own_number(scene, kGroundDamping),
               turn = std::sqrt((1 - zeta) * (1 + zeta)), square = 4 * zeta * zeta;
  return {*scene.noise.deviation, zeta * w, turn * w, zeta * (1 - square) / (turn * (1 + square))};
}

void read_ground(Given& given, model::Scene& scene) {
  if (given.has(kGroundIntensity) && given.has(kDeviation)) {
    return given.refuse(kGroundIntensity,
                        fmt::format("fixes the deviation, and so does -{}", kDeviation),
                        "leave one of them out");
  }
  const double w = given.real(kGroundFrequency), zeta = given.real(kGroundDamping);
  double deviation = 1;
  if (given.has(kGroundIntensity)) {
    const double intensity = given.real(kGroundIntensity);
    scene.own.emplace_back(kGroundIntensity, intensity);
    deviation = std::sqrt(intensity * w * (1 + 4 * zeta * zeta) / (2 * zeta));
  }
  read_plane(given, scene, {kGroundFrequency, kGroundDamping}, deviation, ground_of);
}

model::LevelTable ground_levels(const model::Scene& scene) {
  return lattice_of(ground_of(scene), scene);
}

}  // namespace

const Effect kFilteredNoise{
    .word = "filtered",
    .sentence =
        "white noise through a damped oscillator (Kanai and Tajimi); with -delta on a lattice",
    .others = {"kanai_tajimi", "kanai-tajimi", "tajimi", "ground", "ground_motion", "earthquake",
               "seismic"},
    .parameters =
        {{Option::real(kGroundFrequency, "1/time", "", Range::positive(),
                       "angular frequency w of the oscillator of -noise filtered",
                       "take for example 15.6",
                       {.symbol = "\\omega_g",
                        .label = "frequency of the ground",
                        .slider = Slider{.low = 0.2, .high = 20, .start = 2, .logarithmic = true}}),
          true, "15.6"},
         {Option::real(kGroundDamping, "", "", {0, 1, false, false},
                       "damping ratio zeta of the oscillator of -noise filtered",
                       "take for example 0.6",
                       {.symbol = "\\zeta_g",
                        .label = "damping of the ground",
                        .slider = Slider{.low = 0.2, .high = 0.9, .start = 0.6}}),
          true, "0.6"},
         {Option::real(kGroundIntensity, "force^2 time", "", Range::positive(),
                       "intensity D of the white noise that -noise filtered passes on: half the "
                       "integral of its covariance, pi times its two-sided spectrum per angular "
                       "frequency. X has the variance D w (1 + 4 zeta^2)/(2 zeta)",
                       fmt::format("or give -{} in its place", kDeviation),
                       {.symbol = "D", .label = "intensity of the ground"}),
          true},
         {deviation_option()},
         {delta_option()},
         {radius_option(), true}},
    .read = read_ground,
    .complete = complete_lattice,
    .levels = ground_levels,
    .values = lattice_values,
    .stronger = stronger_lattice,
    .note = [](const model::Scene& scene) { return lattice_note(scene, ground_of(scene)); }};

namespace {

constexpr const char *kBandFrequency = "band_frequency", *kBandWidth = "band_width";

PlaneNoise band_of(const model::Scene& scene) {
  return {*scene.noise.deviation, own_number(scene, kBandWidth), own_number(scene, kBandFrequency)};
}

void read_band(Given& given, model::Scene& scene) {
  read_plane(given, scene, {kBandFrequency, kBandWidth}, 1, band_of);
}

model::LevelTable band_levels(const model::Scene& scene) {
  return lattice_of(band_of(scene), scene);
}

}  // namespace

const Effect kNarrowBand{
    .word = "narrow_band",
    .sentence =
        "Gaussian noise of covariance deviation^2 exp(-gamma t) cos(omega t); with -delta on a "
        "lattice",
    .others = {"narrowband", "band", "harmonic", "waves"},
    .parameters =
        {{Option::real(kBandFrequency, "1/time", "", Range::positive(),
                       "angular frequency omega of -noise narrow_band, at the middle of its band",
                       "take for example 2",
                       {.symbol = "\\omega_0",
                        .label = "frequency of the band",
                        .slider = Slider{.low = 0.2, .high = 10, .start = 2, .logarithmic = true}}),
          true, "2"},
         {Option::real(
              kBandWidth, "1/time", "", Range::positive(),
              "half width gamma of the band: where the spectrum of -noise narrow_band has fallen "
              "to a half. Its covariance decays at this rate",
              "take for example 0.5",
              {.symbol = "\\gamma",
               .label = "half width of the band",
               .slider = Slider{.low = 0.1, .high = 5, .start = 0.5, .logarithmic = true}}),
          true, "0.5"},
         {deviation_option()},
         {delta_option()},
         {radius_option(), true}},
    .read = read_band,
    .complete = complete_lattice,
    .levels = band_levels,
    .values = lattice_values,
    .stronger = stronger_lattice,
    .note = [](const model::Scene& scene) { return lattice_note(scene, band_of(scene)); }};

}  // namespace stickslip::effects
