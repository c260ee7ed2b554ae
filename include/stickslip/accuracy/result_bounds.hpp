#pragma once
/// What holds of results whatever the model parameters.

#include <string>

#include "stickslip/quantities/results.hpp"

namespace stickslip::accuracy {

/// What no result may show, beyond its errors: a probability, a transform F or a distribution
/// function outside [0, 1], an F that rises with lambda, a distribution function that falls with
/// time, a negative second moment, mean duration or spectrum. The first violation in words; empty
/// if there is none. Simulated results scatter, and are not looked at. O(values).
[[nodiscard]] std::string broken_bound(const quantities::Results& results);

}  // namespace stickslip::accuracy
