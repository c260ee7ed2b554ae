#pragma once
/// The motion under a given force, with errors.

#include <string>

#include "stickslip/model/process.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

/// Appends what the force of the scene does to a body that has a velocity at the first sample,
/// in units of its own where the force has one. Errors compare with two motions under forces and
/// drag that differ by rounding, in half the steps, one of them through twice as many samples;
/// infinite where these have another number of slips. Returns why the accuracy is missed, or
/// nothing. Local. O(samples).
[[nodiscard]] std::string append_given_force(const model::Scene& scene, double accuracy,
                                             Results& results, double velocity = 0);

}  // namespace stickslip::quantities
