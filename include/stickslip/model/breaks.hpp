#pragma once
/// Where a formula is not smooth in the speed, and how finely it changes.

#include <cstddef>
#include <functional>
#include <vector>

#include "stickslip/model/expression.hpp"

namespace stickslip::model {

using FunctionOfSpeed = std::function<double(double)>;

/// A jump, a kink or another speed v > 0 at which a formula is not smooth.
struct Break {
  enum class Kind { kink, jump, steep, pole };
  double v;   ///< to rounding
  Kind kind;  ///< steep: its slope has no bound, as that of a root; pole: its values have none
  [[nodiscard]] bool same_as(const Break& other) const;
};

/// Largest |f - p| at 8 places of [a, b], its ends among them, and at those of `places` within, p
/// interpolating f at the 8 Chebyshev nodes between. Not a number where f is none.
[[nodiscard]] double interpolation_error(const FunctionOfSpeed& f, double a, double b,
                                         const std::vector<double>& places = {});

/// What a formula is like as a function of one of its variables.
struct Shape {
  std::vector<Break> breaks;  ///< rising
  /// Speeds, rising, between any two of which f is a polynomial of degree 7 to 1e-10 of its size:
  /// no feature, however narrow, lies between them.
  std::vector<double> places;
  bool resolved = true;  ///< otherwise f has more features than places were allowed
};

/// The shape of |v| -> f at 0 < |v| <= reach, `v` being the place of the velocity among the
/// variables, with that sign, and the others having the values given. By bisection, guided by
/// bounds on f and its derivatives on whole intervals.
[[nodiscard]] Shape shape_of(const Expression& f, const std::vector<double>& values, std::size_t v,
                             double sign, double reach);

/// `found` with those of `more` that are new, rising.
void merge(std::vector<Break>& found, const std::vector<Break>& more);
void merge(std::vector<double>& places, const std::vector<double>& more);

}  // namespace stickslip::model
