#pragma once
/// Functions f(x, y, v) of the state, and of the position on a spring, by name or as an expression.

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "stickslip/base/text.hpp"
#include "stickslip/model/drag.hpp"
#include "stickslip/model/expression.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

// Units of results as products of powers.

/// A product of powers of force (per unit mass), velocity and time. Force is kept apart from
/// velocity/time, so that a unit shows what its number is made of.
struct Unit {
  int force = 0, velocity = 0, time = 0;

  /// Reads what text() writes. O(length). Throws std::invalid_argument for anything else.
  [[nodiscard]] static Unit parse(std::string_view text);
  /// Such as "velocity^2*time", "1/time", "force/(velocity*time)"; empty for a pure number.
  [[nodiscard]] std::string text() const;

  friend bool operator==(const Unit&, const Unit&) = default;
  friend Unit operator/(const Unit& a, const Unit& b) {
    return {a.force - b.force, a.velocity - b.velocity, a.time - b.time};
  }
};

struct Scene;

/// An observable of the process: x the noise, with the position p of a body on a spring, y = sign
/// of the motion (0 at rest), v the velocity.
struct Observable {
  using Function = std::function<double(const Place& x, double y, double v)>;
  std::string name;  ///< as given by the user
  Function value;
  /// Of an expression, in x, y, v, stick, slide and, on a spring, p.
  std::shared_ptr<const Expression> formula = {};
  std::vector<double> numbers = {};  ///< that stand in an expression, mu_s and mu_d included
  bool quadratic = false;  ///< a polynomial in |v|, of degree 2 at most, which every element holds
  bool on_spring = false;  ///< an expression in which the position p is known
  // Set by examine().
  std::vector<Place> levels = {};   ///< x on which it has been looked at
  std::vector<double> breaks = {};  ///< |v| at which it jumps or has a kink on any of them, rising
  std::vector<double> places = {};  ///< |v| that show all of it on any of them, see Shape
  double least = -kInfinity;        ///< of the values seen
  double most = kInfinity;

  /// Whether all values seen lie in [0, 1], as those of an indicator do.
  [[nodiscard]] bool within_unit() const { return least >= 0 && most <= 1; }
  [[nodiscard]] double operator()(const Place& x, double y, double v) const {
    return value(x, y, v);
  }
  /// (f(x, y, v) + f(-x, -y, -v))/2 and the odd counterpart.
  [[nodiscard]] double even(const Place& x, double y, double v) const {
    return (value(x, y, v) + value(-x, -y, -v)) / 2;
  }
  [[nodiscard]] double odd(const Place& x, double y, double v) const {
    return (value(x, y, v) - value(-x, -y, -v)) / 2;
  }
};

/// Names that need no expression: 1, x, v, v^2, |v|, stick, slide, |x|<=mu_s.
[[nodiscard]] const std::vector<std::string>& observable_names();

/// A named observable or an expression in x, y, v, stick and slide (and mu_s, mu_d), such as "x*v"
/// or "stick*x^2", and of a body on a spring in its position p, read by muParser. Levels that equal
/// mu_s up to rounding count as below it in |x|<=mu_s. Throws std::invalid_argument with the
/// parser's message and the place of the error, and for an assignment, more than one expression, or
/// one that is not finite at rest or in slow motion. Where an expression is not finite in another
/// state, its value throws Failure of bad input.
[[nodiscard]] Observable parse_observable(const std::string& text, const Friction& friction,
                                          bool on_spring = false);

/// |v| -> f(x, sign, sign |v|); not a number where f is not finite.
[[nodiscard]] FunctionOfSpeed section(std::shared_ptr<const Observable> f, const Place& x,
                                      double sign);

/// F(v) |v| with the F of the direction: the power that dry friction takes.
[[nodiscard]] Observable friction_power(const Friction& friction);

/// Finds the breaks of f in v, 0 < |v| <= reach, on the levels x and for both signs of v, by its
/// shape(). Throws std::invalid_argument, with the reason, where f is unbounded, for more
/// than 64 breaks, and for one on a level `step` nearer to 0, between levels of x, that none of
/// these shows: it moves with x, and elements cannot end there on all levels; or for more features
/// than can be resolved. Jumps at v = 0 and in x do not count.
void examine(Observable& f, const std::vector<Place>& x, double step, double reach);

/// The same on up to 17 levels of the noise, evenly, and on those next to the numbers of f.
void examine(Observable& f, const Scene& scene, double reach);

}  // namespace stickslip::model
