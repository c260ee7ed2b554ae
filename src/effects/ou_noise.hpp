#pragma once
/// The correlation time, which formulas may hold whatever the noise.

#include "stickslip/effects/option.hpp"

namespace stickslip::effects {

inline constexpr const char* kTau = "tau";
[[nodiscard]] Option tau_option();

}  // namespace stickslip::effects
