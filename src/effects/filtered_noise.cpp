#include <fmt/format.h>

#include <cmath>

#include "all.hpp"
#include "ou_noise.hpp"
#include "plane_lattice.hpp"

namespace stickslip::effects {
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
  read_lattice(given, scene, {kGroundFrequency, kGroundDamping}, deviation);
  scene.noise.target = spectrum_of(ground_of(scene));
}

model::LevelTable ground_levels(const model::Scene& scene) {
  return lattice_of(ground_of(scene), scene);
}

}  // namespace

const Effect kFilteredNoise{
    .word = "filtered",
    .sentence = "white noise through a damped oscillator (Kanai and Tajimi), on a lattice",
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

}  // namespace stickslip::effects
