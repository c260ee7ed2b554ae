#pragma once
/// Model parameters by hand, and discretisations of them.

#include <memory>
#include <vector>

#include "stickslip/model/process.hpp"
#include "stickslip/run/discretise.hpp"

namespace stickslip::test {

inline model::Scene scene(double mu_s, double mu_d, double tau, double delta, model::Drag drag) {
  model::Scene s;
  s.friction = {mu_s, mu_d};
  s.tau = tau;
  s.delta = delta;
  s.drag = drag;
  return s;
}

/// The same under a constant force.
inline model::Scene biased(model::Scene s, double bias) {
  s.bias = bias;
  return s;
}

/// The same with lower thresholds of friction downwards.
inline model::Scene by_direction(model::Scene s) {
  s.friction.mu_s_minus = 0.8 * s.friction.mu_s;
  s.friction.mu_d_minus = 0.8 * s.friction.mu_d;
  return s;
}

/// Telegraph noise beside a constant force: bodies rest on the lower level, and move on the upper.
inline model::Scene pushed_by_telegraph() {
  auto s = scene(1, 0.55, 1, 1, {0.5, 0});
  s.noise.name = "telegraph";
  s.noise.table = std::make_shared<const model::LevelTable>(
      std::vector<model::Level>{{-1.2, 0.8, 0}, {1.2, 0, 0.8}});
  return biased(s, 0.25);
}

/// The same with the whole noise range.
inline model::Scene on_full_noise(model::Scene s) {
  s.noise_levels = s.full_levels();
  return s;
}

using Discrete = generator::Discretisation;

/// hp with noise range and truncation velocity for errors of `tolerance`.
inline Discrete on_hp(const model::Scene& s, int degree, double tolerance = 1e-12) {
  return run::discretise(s, run::hp_resolution(s, degree, 0, tolerance));
}

/// The same on noise nodes.
inline Discrete on_nodes(const model::Scene& s, int degree, int noise_degree,
                         double tolerance = 1e-12) {
  return run::discretise(s, run::hp_resolution(s, degree, 0, tolerance, {}, {noise_degree}));
}

/// Upwind with `points` nodes per noise step.
inline Discrete on_upwind(const model::Scene& s, int points, double tolerance = 1e-8) {
  return run::discretise(s, run::upwind_resolution(s, points, tolerance));
}

}  // namespace stickslip::test
