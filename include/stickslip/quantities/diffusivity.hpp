#pragma once
/// Diffusion of the position about its drift.

#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// S_v(0) of V - E[V], also without symmetry: 2 pi((V - m) u) where -L u = V - m, m = E[V]. With
/// u = 0 at s-, u = w + d h, h the probability of the next start being s+ and w the mean of
/// int (V - m) dt up to it, where u(s+) = d gives d P(s+ to s-) = w(s+). Two plain solves with the
/// system of the law, which must not be symmetric. Collective.
[[nodiscard]] Uncertain spectrum_at_zero(operators::Systems& systems,
                                         const StationaryDistribution& distribution);

}  // namespace stickslip::quantities
