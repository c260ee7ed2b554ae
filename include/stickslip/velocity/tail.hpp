#pragma once
/// How far the velocity discretisation must reach.

#include "stickslip/model/process.hpp"

namespace stickslip::velocity {

/// Velocity beyond which the stationary density is below `tolerance`, from its white-noise bound
/// exp(-(mu_d - |bias|) v + int_0^v b): coloured noise and discrete levels only shorten the tail.
/// Without drag the bias must be smaller than mu_d.
[[nodiscard]] double tail_velocity(const model::Process& process, double tolerance);

}  // namespace stickslip::velocity
