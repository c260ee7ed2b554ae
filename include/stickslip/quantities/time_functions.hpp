#pragma once
/// c exp(L t) b on a reduced model.

#include <vector>

#include "stickslip/quantities/reduced_model.hpp"
#include "stickslip/quantities/uncertain.hpp"

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

/// Whether the integral of a curve is wanted too, to the tolerance itself.
enum class Integral { wanted, left_out };

/// c exp(L t) b to `tolerance` times `unit`, and its integral from 0 to t, with their errors, by
/// reduced models grown until they stand still.
struct TimeCurve {
  std::vector<Uncertain> value, integral;  ///< no integral if it is left out
  int pairs = 0;                           ///< of vectors of the reduced model
};
/// `minus_l` is -L with the static states as `rest` says. Collective.
[[nodiscard]] TimeCurve time_curve(operators::Systems& systems,
                                   operators::KolmogorovOperator minus_l,
                                   operators::StaticPhase rest, const Ends& ends,
                                   ReducedModel::Nature nature, Integral integral,
                                   const std::vector<double>& time, double unit, double tolerance);

}  // namespace stickslip::quantities
