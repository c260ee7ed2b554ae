#pragma once
/// Where a body is after a time.

#include <vector>

#include "stickslip/model/process.hpp"
#include "stickslip/quantities/correlations.hpp"
#include "stickslip/quantities/engines/propagator.hpp"

namespace stickslip::quantities {

/// By time.
struct Displacement {
  std::vector<Uncertain> mean;      ///< E[x(t)], x(t) = int_0^t V [velocity time]
  std::vector<Uncertain> variance;  ///< of x(t)
};

/// With V = m + V', m = E[V], x(t) = m t + y(t). From the stationary distribution y has mean 0 and
/// the variance 2 int_0^t (t - s) C(s) ds, C the autocovariance of the velocity. From any other
/// start its moments follow the backward equations
///
///   dm1/dt = L m1 + v',   dm2/dt = L m2 + 2 v' m1,
///
/// which one reduced model of both together solves for all times: up to ten correlation times by
/// themselves, for longer times what the start adds to the second moment from the stationary
/// distribution, which stays bounded. Errors are relative to the variance at the largest time.
/// Collective. Throws NotReached or NoMemory.
[[nodiscard]] Displacement displacement(generator::Systems& systems,
                                        const StationaryDistribution& distribution,
                                        const model::Start& start, const std::vector<double>& time,
                                        const ModelTolerance& tolerance);

}  // namespace stickslip::quantities
