#pragma once
/// Options of Gaussian noise. Formulas may hold the correlation time whatever the noise.

#include "stickslip/effects/option.hpp"

namespace stickslip::effects {

inline constexpr const char *kTau = "tau", *kDelta = "delta", *kLevels = "noise_levels",
                            *kDeviation = "noise_deviation";
[[nodiscard]] Option tau_option();
[[nodiscard]] Option delta_option();
[[nodiscard]] Option deviation_option();

}  // namespace stickslip::effects
