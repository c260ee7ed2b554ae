#pragma once
/// The double without an end.

#include <limits>

namespace stickslip {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace stickslip
