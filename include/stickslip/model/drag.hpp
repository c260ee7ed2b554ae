#pragma once
/// Drag b(v): a force with b(0) = 0, as a rule falling with v.

#include <functional>
#include <vector>

#include "stickslip/model/friction.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::model {

/// b(v) = -linear v - cubic v^3 with linear, cubic >= 0; both zero means no drag. Or any other drag
/// law, see drag_law.hpp; a copy of it shares nothing, and threads need one each.
struct Drag {
  double linear = 1;                       ///< c [1/time]
  double cubic = 0;                        ///< c3 [time/length^2]
  std::function<double(double)> law = {};  ///< b(v), which then counts instead of the coefficients
  /// |v| up to which a law is known to be sound: twice the largest terminal velocity, or far in the
  /// tail.
  double reach = kInfinity;
  bool law_is_odd = true;           ///< b(-v) = -b(v)
  std::vector<double> breaks = {};  ///< |v| > 0 at which a law has kinks, rising
  double rises_until = 0;           ///< |v| beyond which a law falls; 0: it falls everywhere
  std::vector<double> places = {};  ///< |v| that show all of a law on either side, see Shape

  /// b(v) [force].
  [[nodiscard]] double operator()(double v) const {
    return law ? law(v) : -(linear + cubic * v * v) * v;
  }
  /// Whether b(v) = -linear v, 0 included.
  [[nodiscard]] bool is_linear() const { return !law && cubic == 0; }
  /// Whether b = 0. No expression counts as that.
  [[nodiscard]] bool is_none() const { return is_linear() && linear == 0; }
  /// b'(0+), by extrapolated differences for a law.
  [[nodiscard]] double slope_at_rest() const;
  /// Largest |b'| on (0, v), for a law an estimate within a factor of about 2.
  [[nodiscard]] double steepest(double v) const;
  /// int_0^v b(s) ds, by quadrature for a law.
  [[nodiscard]] double potential(double v) const;
  /// Whether b tends to -infinity, so that a constant force has a terminal velocity. Of a law the
  /// values at very large v decide.
  [[nodiscard]] bool bounds_velocity() const;
  /// Smallest v >= 0 with force + b(v) <= 0, to rounding and on that side of it; infinity when
  /// there is none.
  [[nodiscard]] double terminal_velocity(double force) const;
  /// For a law that rises somewhere: all v > 0 at which force + b(v) changes its sign, rising, each
  /// to rounding and beyond it. Of two between the same speeds() neither is found.
  [[nodiscard]] std::vector<double> balances(double force) const;
  /// Largest b on [0, v], to about 1e-4 of it.
  [[nodiscard]] double highest(double v) const;
  /// Speeds from `from` to `to`, rising: in ratios of 1.01 where a law may rise and of 2 beyond,
  /// and its places.
  [[nodiscard]] std::vector<double> speeds(double from, double to) const;
  /// A speed that has the unit in which a law is written.
  [[nodiscard]] double scale() const;

  [[nodiscard]] bool odd() const { return !law || law_is_odd; }
  /// v -> -b(-v), the drag in the mirror.
  [[nodiscard]] Drag mirrored() const;
};

/// b(v) + F(0+) - F(v) on v > 0, and likewise on v < 0: b itself where friction does not weaken.
[[nodiscard]] Drag with_weakening(const Drag& drag, const Friction& friction);

}  // namespace stickslip::model
