#pragma once
/// A force over time from a file.

#include <vector>

#include "stickslip/effects/effect.hpp"

namespace stickslip::effects {

/// Its options.
[[nodiscard]] std::vector<Option> force_options();

/// Reads the record that they name, if any, into a scene; what is wrong with it is refused.
void read_force(Given& given, model::Scene& scene);

}  // namespace stickslip::effects
