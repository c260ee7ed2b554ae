#pragma once
/// Drag b(v): a force with b(0) = 0, as a rule falling with v.

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "stickslip/base/text.hpp"

namespace stickslip::model {

// Dry friction: a static threshold and a dynamic force, each by direction.

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

/// b(v) = -linear v - cubic v^3 with linear, cubic >= 0; both zero means no drag. Or any other drag
/// law, see drag.hpp; a copy of it shares nothing, and threads need one each.
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

// Drag laws as users write them, and what is asked of them.

/// A text that is no drag law: what() says why, fix() what to do.
class UnfitLaw : public std::invalid_argument {
 public:
  UnfitLaw(const std::string& why, std::string fix)
      : std::invalid_argument(why), fix_(std::move(fix)) {}
  [[nodiscard]] const std::string& fix() const { return fix_; }

 private:
  std::string fix_;
};

/// b(v) from an expression in v, mu_s, mu_d and tau, known to be sound on both sides: b(0) = 0,
/// finite and with bounded slopes on the velocities that can occur. They end at twice the terminal
/// velocity under `force`, or where the density is below exp(-51); a law that lets a body run away
/// has no such end. b is sampled there at 3000 places. `force` is the largest that occurs, with the
/// bias and less mu_d, `bias` the mean one, `intensity` that of the noise at large speeds. Throws
/// UnfitLaw.
[[nodiscard]] Drag parse_drag(const std::string& text, const Friction& friction, double tau,
                              double force, double bias = 0, double intensity = 1);

}  // namespace stickslip::model
