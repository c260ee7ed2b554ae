#pragma once
/// Gaussian noises of two states, the force and a second one, as chains on a lattice.

#include <functional>
#include <initializer_list>
#include <string>

#include "levels.hpp"

namespace stickslip::effects {

inline constexpr const char* kRadius = "noise_radius";
[[nodiscard]] Option radius_option();

/// Stationary Gaussian noise with the covariance deviation^2 exp(-decay t) (cos(frequency t) + sine
/// sin(frequency t)), decay >= sine frequency.
struct PlaneNoise {
  double deviation;         ///< [force]
  double decay, frequency;  ///< [1/time]
  double sine = 0;
};

/// The power spectral density of such a noise.
[[nodiscard]] std::function<double(double)> spectrum_of(const PlaneNoise& noise);

/// Reads the options of its own, which are numbers, the deviation, if it is given, -delta and
/// -noise_radius of a lattice. Unless given, the step is about half the deviation, with mu_s
/// halfway between two levels.
void read_lattice(Given& given, model::Scene& scene, std::initializer_list<const char*> own,
                  double deviation);

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

}  // namespace stickslip::effects
