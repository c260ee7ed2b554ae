#pragma once
/// A number that carries a bound for its error through arithmetic, and intervals.

#include <cmath>
#include <limits>

namespace stickslip {

/// value with |error| to first order: bounds add, as worst cases do.
struct Uncertain {
  double value = 0;
  double error = 0;
};

/// Of what has no value.
inline constexpr Uncertain kNoValue{std::numeric_limits<double>::quiet_NaN(),
                                    std::numeric_limits<double>::quiet_NaN()};

[[nodiscard]] inline Uncertain operator+(Uncertain a, Uncertain b) {
  return {a.value + b.value, a.error + b.error};
}
[[nodiscard]] inline Uncertain operator-(Uncertain a, Uncertain b) {
  return {a.value - b.value, a.error + b.error};
}
[[nodiscard]] inline Uncertain operator*(Uncertain a, Uncertain b) {
  return {a.value * b.value, std::abs(a.value) * b.error + std::abs(b.value) * a.error};
}
[[nodiscard]] inline Uncertain operator/(Uncertain a, Uncertain b) {
  const double q = a.value / b.value;
  return {q, (a.error + std::abs(q) * b.error) / std::abs(b.value)};
}
[[nodiscard]] inline Uncertain operator*(double factor, Uncertain a) {
  return {factor * a.value, std::abs(factor) * a.error};
}

/// Half the width of a two-sided 95 % confidence interval in standard deviations, printed as 1.96.
inline constexpr double kNormalQuantile = 1.959963984540054;

}  // namespace stickslip
