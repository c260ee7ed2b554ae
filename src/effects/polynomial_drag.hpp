#pragma once
/// What drag laws with coefficients share.

#include "stickslip/effects/effect.hpp"

namespace stickslip::effects {

inline constexpr const char* kDragCoefficient = "drag_coefficient";
inline constexpr const char* kDragMayNotGrow =
    "the drag must not grow with the velocity, it would drive the body";

[[nodiscard]] Option drag_coefficient();
void read_linear_drag(Given& given, model::Scene& scene);

/// Derivative by the coefficient.
[[nodiscard]] model::Derivative by_drag_coefficient();

/// Files state the coefficients of all of them.
[[nodiscard]] model::Parameters drag_coefficients(const model::Scene& scene);
[[nodiscard]] std::string drag_heading(const model::Scene& scene);

}  // namespace stickslip::effects
