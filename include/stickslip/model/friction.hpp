#pragma once
/// Coulomb friction: a static threshold and a dynamic force, each by direction.

#include <optional>

namespace stickslip::model {

struct Friction {
  double mu_s = 1;  ///< static coefficient against motion towards positive v [force]
  double mu_d = 1;  ///< dynamic coefficient while v > 0 [force], 0 < mu_d <= mu_s
  /// The same towards negative v, where they differ.
  std::optional<double> mu_s_minus = {}, mu_d_minus = {};

  /// Whether both directions are alike.
  [[nodiscard]] bool symmetric() const;
  /// The directions exchanged.
  [[nodiscard]] Friction mirrored() const;

  /// x_i + g - mu_d, the acceleration of a body that starts to slide upwards; exactly 0 for a level
  /// that equals mu_d - g up to rounding.
  [[nodiscard]] double net_force(double level, double bias = 0) const;
};

}  // namespace stickslip::model
