#pragma once
/// Scenes by hand, and discretisations of them.

#include <memory>

#include "stickslip/accuracy/resolution.hpp"
#include "stickslip/model/scene.hpp"
#include "stickslip/velocity/axis.hpp"

namespace stickslip::test {

inline model::Scene scene(double mu_s, double mu_d, double tau, double delta, model::Drag drag) {
  model::Scene s;
  s.friction = {mu_s, mu_d};
  s.tau = tau;
  s.delta = delta;
  s.drag = drag;
  return s;
}

/// The same with the whole noise range.
inline model::Scene on_full_noise(model::Scene s) {
  s.noise_levels = s.full_levels();
  return s;
}

struct Discrete {
  model::Process process;
  std::shared_ptr<const velocity::Axis> axis;
};

inline Discrete discretise(const model::Scene& s, const accuracy::Resolution& resolution) {
  return {s.process(resolution.levels), accuracy::make_axis(s, resolution)};
}

/// hp with noise range and velocity cut for errors of `tolerance`.
inline Discrete on_hp(const model::Scene& s, int degree, double tolerance = 1e-12) {
  return discretise(s, accuracy::hp_resolution(s, degree, 0, tolerance));
}

/// The same elements and levels with two degrees.
struct TwoDegrees {
  Discrete coarse, fine;
};

inline TwoDegrees on_two_degrees(const model::Scene& s, int low, int high) {
  auto resolution = accuracy::hp_resolution(s, low, 0, 1e-12);
  const Discrete coarse = discretise(s, resolution);
  resolution.degree = high;
  return {coarse, discretise(s, resolution)};
}

/// Upwind with `points` nodes per noise step.
inline Discrete on_upwind(const model::Scene& s, int points, double tolerance = 1e-8) {
  return discretise(s, accuracy::upwind_resolution(s, points, tolerance));
}

}  // namespace stickslip::test
