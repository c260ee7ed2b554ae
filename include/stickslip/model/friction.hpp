#pragma once
/// Coulomb friction: a static threshold and a dynamic force.

namespace stickslip::model {

struct Friction {
  double mu_s = 1;  ///< static coefficient [force]
  double mu_d = 1;  ///< dynamic coefficient [force], 0 < mu_d <= mu_s

  /// k with x_k <= mu_s < x_{k+1}: the static phase holds the levels |i| <= k.
  /// Rounding of mu_s/delta never moves it. Throws std::out_of_range beyond int.
  [[nodiscard]] int static_index(double delta) const;

  /// x_i - mu_d, the acceleration of a body that starts to slide upwards; exactly 0 for a level
  /// that equals mu_d up to rounding.
  [[nodiscard]] double excess(double level) const;
};

}  // namespace stickslip::model
