#pragma once
/// Relative closeness with a stated tolerance.

#include <algorithm>
#include <cmath>

namespace stickslip::test {

/// |a - b| / max(|a|, |b|), and 0 for two equal numbers.
inline double relative_difference(double a, double b) {
  if (a == b) return 0;
  return std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}

}  // namespace stickslip::test
