#pragma once
/// Error estimates of results: what refinement shows, and what it cannot show.

#include <vector>

#include "stickslip/quantities/results.hpp"

namespace stickslip::accuracy {

/// error >= rounding |value| for every value. Sums of positive terms over levels are rounded even
/// where nothing else is wrong, as for a mean duration of sticking that has the same hitting
/// distribution on every discretisation.
void require_rounding(double rounding, quantities::Results& results);

/// |change| from one discretisation to the next, by result and entry.
using Changes = std::vector<std::vector<double>>;

/// By how much an error exceeds a change.
struct ErrorPerChange {
  double last = 1;     ///< the change to this discretisation
  double earlier = 0;  ///< the change to the one before
};

/// error += max(last |change from coarse|, earlier |change before|), then the means share their
/// errors, see share_errors(). A value that `coarse` lacks is all change; `before` is empty where
/// there are no two coarser discretisations. Returns the changes from `coarse`.
[[nodiscard]] Changes add_discretisation(const ErrorPerChange& factor,
                                         const quantities::Results& coarse, const Changes& before,
                                         quantities::Results& results);

/// A change from grid to grid that passes through zero hides an error, which the other means of the
/// same stationary distribution show: no mean gets a relative error below a twentieth of the
/// largest one among them, unless it does not change at all (relative error 1e-13). P_stick and
/// P_slide, of which P_slide / P_stick is a ratio of two means, get that share of
/// P_stick P_slide.
void share_errors(quantities::Results& results);

}  // namespace stickslip::accuracy
