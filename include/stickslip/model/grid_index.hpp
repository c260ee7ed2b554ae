#pragma once
/// Indices of grid points, safe against rounding.

namespace stickslip::model {

/// Largest integer n with n <= ratio, where a ratio within a few units of rounding of an integer
/// counts as that integer: 0.3/0.1 gives 3, 2/0.1^2 gives 200, while (1 - 1e-12)/0.25 gives 3.
/// Throws std::out_of_range when the result does not fit an int.
[[nodiscard]] int floor_index(double ratio);

/// a - b, or exactly 0 when a and b differ by no more than the rounding of their computation.
[[nodiscard]] double snapped_difference(double a, double b);

}  // namespace stickslip::model
