#pragma once
/// Dry friction: a static threshold and a dynamic force, each by direction.

#include <optional>

namespace stickslip::model {

/// Friction that falls from mu_s at rest to mu_d at high speeds, the difference like
/// exp(-(|v|/velocity)^exponent).
struct Stribeck {
  double velocity;      ///< v_s > 0
  double exponent = 1;  ///< gamma > 0

  /// The share of mu_s - mu_d that is gone at the speed v > 0, and its derivative by v_s.
  [[nodiscard]] double share(double v) const;
  [[nodiscard]] double share_by_velocity(double v) const;
};

/// Coulomb friction, mu_d at every speed, unless `stribeck` is there.
struct Friction {
  double mu_s = 1;  ///< static coefficient against motion towards positive v [force]
  double mu_d = 1;  ///< dynamic coefficient while v > 0 [force], 0 < mu_d <= mu_s
  /// The same towards negative v, where they differ.
  std::optional<double> mu_s_minus = {}, mu_d_minus = {};
  std::optional<Stribeck> stribeck = {};

  /// Whether both directions are alike.
  [[nodiscard]] bool symmetric() const;
  /// The directions exchanged.
  [[nodiscard]] Friction mirrored() const;

  /// F(0+), F(0+) - F(v) >= 0 and F(v), the force that friction takes at the speed v > 0.
  [[nodiscard]] double at_rest() const { return stribeck ? mu_s : mu_d; }
  [[nodiscard]] double weakening(double v) const { return (at_rest() - mu_d) * share(v); }
  [[nodiscard]] double operator()(double v) const { return at_rest() - weakening(v); }
  /// Whether it does so in a direction.
  [[nodiscard]] bool weakens() const;
  /// That of mu_d in F(v); the rest is that of mu_s.
  [[nodiscard]] double share(double v) const { return stribeck ? stribeck->share(v) : 1; }

  /// x_i + g - F(0+), the acceleration of a body that starts to slide upwards; exactly 0 for a
  /// level that equals F(0+) - g up to rounding.
  [[nodiscard]] double net_force(double level, double bias = 0) const;
};

}  // namespace stickslip::model
