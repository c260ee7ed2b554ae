#pragma once
/// How far the velocity discretisation must reach.

#include "stickslip/model/scene.hpp"

namespace stickslip::velocity {

/// Velocity beyond which the stationary density is below `tolerance`, from its white-noise bound
/// exp(-(mu_d - |bias|) v + int_0^v b): coloured noise and discrete levels only shorten the tail.
/// Without drag the bias must be smaller than mu_d. With a tilt s >= 0 of either sign of v, the
/// same of the density weighted with exp(s x(t)), which falls at the rate
///
///   ((F/D)^2 - 4 s v/D)^1/2,   F = mu_d - |bias| - b(v), D the intensity,
///
/// where that is real; infinity where it never is.
[[nodiscard]] double tail_velocity(const model::Process& process, double tolerance,
                                   double tilt = 0);

/// |v| beyond which nothing counts in double precision, by the density, the largest force that
/// occurs and a truncation velocity given by hand.
[[nodiscard]] double largest_speed(const model::Scene& scene);

}  // namespace stickslip::velocity
