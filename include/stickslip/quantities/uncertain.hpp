#pragma once
/// Numbers that carry a bound for their error through arithmetic.

#include <cmath>
#include <limits>

#include "stickslip/petsc/factorization.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

/// value with |error| to first order: bounds add, as worst cases do.
struct Uncertain {
  double value = 0;
  double error = 0;
};

/// Of an entry without a value (Result::unreached).
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

/// functional . solution, with the effect of iterative refinement as its rounding. Collective.
[[nodiscard]] Uncertain value_of(Vec functional, const petsc::Solution& solution);

[[nodiscard]] inline Result scalar(Result blank, Uncertain value) {
  return scalar(std::move(blank), value.value, value.error);
}
[[nodiscard]] inline Result scalar(const Row& row, Uncertain value) {
  return scalar(blank(row), value);
}

inline void append_value(Result& array, Uncertain value) {
  array.value.push_back(value.value);
  array.error.push_back(value.error);
}

/// Appends an array with these values to the results.
inline void append_array(Result array, const std::vector<Uncertain>& values, Results& results) {
  for (const auto& value : values) append_value(array, value);
  results.push_back(std::move(array));
}

}  // namespace stickslip::quantities
