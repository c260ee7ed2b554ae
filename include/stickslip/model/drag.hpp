#pragma once
/// Drag b(v): an odd, non-increasing force with b(0) = 0.

namespace stickslip::model {

/// b(v) = -linear v - cubic v^3 with linear, cubic >= 0. Both zero means no drag.
struct Drag {
  double linear = 1;  ///< c [1/time]
  double cubic = 0;   ///< c3 [time/length^2]

  /// b(v) [force].
  [[nodiscard]] double operator()(double v) const { return -(linear + cubic * v * v) * v; }
  /// b'(0) = -linear.
  [[nodiscard]] double slope_at_rest() const { return -linear; }
  /// int_0^v b(s) ds.
  [[nodiscard]] double potential(double v) const {
    return -(linear / 2 + cubic * v * v / 4) * v * v;
  }
  /// Whether b tends to -infinity, so that a constant force has a terminal velocity.
  [[nodiscard]] bool bounds_velocity() const { return linear > 0 || cubic > 0; }
  /// Smallest v >= 0 with force + b(v) <= 0, to rounding and on that side of it; infinity when
  /// there is none.
  [[nodiscard]] double terminal_velocity(double force) const;
};

}  // namespace stickslip::model
