#pragma once
/// c exp(L t) b on a reduced model.

#include <vector>

#include "stickslip/quantities/reduced_model.hpp"

namespace stickslip::quantities {

/// Values of c exp(L t) b and of its integral from 0 to t, one for each time.
struct TimeFunction {
  std::vector<double> value, integral;
};

/// By quadrature of the inverse Laplace transform on Talbot's contour with the parameters of
/// Weideman (SIAM J. Numer. Anal. 44, 2006), whose error is about 10^-14 of the largest value.
/// Growing modes that a two-sided projection may have lie outside the contour and do no harm, as
/// they would to exp(m t). Local. O(size^2) a time. Times >= 0.
[[nodiscard]] TimeFunction evaluate(const Reduced& reduced, const std::vector<double>& time);

}  // namespace stickslip::quantities
