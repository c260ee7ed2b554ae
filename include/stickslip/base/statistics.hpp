#pragma once
/// Numbers of the normal distribution.

namespace stickslip {

/// Half the width of a two-sided 95 % confidence interval in standard deviations, printed as 1.96.
inline constexpr double kNormalQuantile = 1.959963984540054;

}  // namespace stickslip
