#pragma once
/// c exp(-A t) b and its integrals on reduced models.

#include <vector>

#include "stickslip/quantities/model_search.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// Inverse Laplace transforms at the time t take rates up to this over t.
constexpr double kFastestOnContour = 12;

/// n-fold integrals from 0 to t of gamma exp(m t) beta, for each n of `folds` one for each time >
/// 0, by quadrature of the inverse Laplace transform on Talbot's contour with the parameters of
/// Weideman (SIAM J. Numer. Anal. 44, 2006); the error is three times what a narrower contour makes
/// of it. Growing modes that a two-sided projection may have lie outside the contour and do no
/// harm, as they would to exp(m t). Local. O(size^2) a time.
[[nodiscard]] std::vector<std::vector<Uncertain>>
evaluate(const Reduced& reduced, const std::vector<double>& time, const std::vector<int>& folds);

/// An n-fold integral that is wanted to a tolerance times `unit`.
struct Fold {
  int n;
  double unit;
};

/// How fast things happen: the correlation time of the noise, its rate, and the time in which a
/// body of a typical speed stops, by the clock of a pencil.
struct TimeScales {
  double correlation, rate, stopping;
};

/// Integrals of c exp(-A t) b with their errors, by fold and time.
struct TimeCurve {
  std::vector<std::vector<Uncertain>> value;
  int pairs = 0;  ///< of vectors of the reduced model
};
/// By reduced models grown until they stand still; what they miss of the tolerance is in the
/// errors. Collective.
[[nodiscard]] TimeCurve time_curve(Pencil& pencil, const Ends& ends, ReducedModel::Nature nature,
                                   const std::vector<Fold>& folds, const std::vector<double>& time,
                                   const TimeScales& scales, double tolerance, Recipe& recipe);
/// Those of a process, by the clock of time.
[[nodiscard]] TimeScales time_scales(const model::Process& process);

}  // namespace stickslip::quantities
