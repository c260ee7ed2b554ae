#pragma once
/// Slip events: how far bodies slide from one sticking phase to the next.

#include <vector>

#include "stickslip/quantities/durations.hpp"

namespace stickslip::quantities {

/// Mean and variance of the path length int |V| dt and of the net displacement int V dt of a
/// sliding phase, over sliding phases as they follow one another.
struct SlipMoments {
  Uncertain variance;                ///< of the path length [velocity^2 time^2]
  Uncertain net_mean, net_variance;  ///< of the displacement
};

/// A path length is a duration by a clock that runs at the speed |v|: with A = -L killed at rest,
///
///   E[S] = nu |v|,   E[S^2] = 2 g A^-1 |v| A^-1 |v|,   E[D^2] = 2 g A^-1 v A^-1 v,
///
/// where v A^-1 v is even with symmetry and A^-1 v odd. Four solves, one of them with
/// systems.at(0, odd) if there is symmetry. Collective.
[[nodiscard]] SlipMoments slip_moments(generator::Systems& systems,
                                       const StationaryDistribution& distribution);

/// E[exp(-s S)]: a solve with s |v| - L. Collective. s >= 0 [1/(velocity time)].
[[nodiscard]] Uncertain slip_transform(generator::Systems& systems,
                                       const StationaryDistribution& distribution, double s);

/// Density and distribution function of S at distances > 0, from the same reduced models as
/// durations, by the other clock. Collective.
[[nodiscard]] DurationDistribution slip_distribution(generator::Systems& systems,
                                                     const StationaryDistribution& distribution,
                                                     const std::vector<double>& distance,
                                                     const ModelTolerance& tolerance);

/// E[S] = E|V| mean_excursion.
void append_mean_slip(const Excursion& excursion, Results& results);

}  // namespace stickslip::quantities
