#pragma once
/// Functions f(x, y, v) of the state, by name or as an expression.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "stickslip/model/friction.hpp"

namespace stickslip::model {

/// An observable of the process: x the noise, y = sign of the motion (0 at rest), v the velocity.
struct Observable {
  using Function = std::function<double(double x, double y, double v)>;
  std::string name;  ///< as given by the user
  Function value;
  std::vector<double> numbers = {};  ///< that stand in an expression, mu_s and mu_d included

  [[nodiscard]] double operator()(double x, double y, double v) const { return value(x, y, v); }
  /// (f(x, y, v) + f(-x, -y, -v))/2 and the odd counterpart.
  [[nodiscard]] double even(double x, double y, double v) const {
    return (value(x, y, v) + value(-x, -y, -v)) / 2;
  }
  [[nodiscard]] double odd(double x, double y, double v) const {
    return (value(x, y, v) - value(-x, -y, -v)) / 2;
  }
};

/// Names that need no expression: 1, x, v, v^2, |v|, stick, slide, |x|<=mu_s.
[[nodiscard]] const std::vector<std::string>& observable_names();

/// A named observable or an expression in x, y, v (and mu_s, mu_d), such as "x*v" or
/// "y == 0 ? x^2 : 0", read by muParser. Levels that equal mu_s up to rounding count as below it in
/// |x|<=mu_s. Throws std::invalid_argument with the parser's message and the place of the error,
/// and for an assignment, more than one expression, or one that is not finite at rest or in slow
/// motion. Where an expression is not finite in another state, its value throws Failure of bad
/// input.
[[nodiscard]] Observable parse_observable(const std::string& text, const Friction& friction);

/// A state at which an observable jumps in v, to the precision of v.
struct Jump {
  double x, y, v;
};

/// Where f(x, sign v, v) jumps in v, found on the given levels x and those v, 0 < |v| <= reach,
/// that 2000 places on each side and places around the numbers of f show; nothing if it is
/// continuous there. Jumps at v = 0 do not count. A steep function that doubles resolve does not
/// jump, a kink neither. Narrow windows are found if their ends are numbers of f or levels, sums or
/// differences of two of these.
[[nodiscard]] std::optional<Jump> velocity_jump(const Observable& f, const std::vector<double>& x,
                                                double reach);

}  // namespace stickslip::model
