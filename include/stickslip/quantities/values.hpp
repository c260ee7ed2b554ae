#pragma once
/// Values of solutions with their errors, and how results are made of them.

#include <utility>
#include <vector>

#include "stickslip/base/uncertain.hpp"
#include "stickslip/linalg/solver.hpp"
#include "stickslip/quantities/results.hpp"

namespace stickslip::quantities {

using stickslip::kNoValue;
using stickslip::Uncertain;

/// functional . solution, with the effect of iterative refinement as its rounding. Collective.
[[nodiscard]] Uncertain value_of(Vec functional, const linalg::Solution& solution);

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
