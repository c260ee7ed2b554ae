#pragma once
/// The largest force of a scene.

#include "stickslip/model/scene.hpp"

namespace stickslip::model {

/// The largest force on a body that slides [force]: X passes mu_s by 12 standard deviations with
/// probability e^-72. A given force counts as well.
[[nodiscard]] double largest_force(const Scene& scene);

}  // namespace stickslip::model
