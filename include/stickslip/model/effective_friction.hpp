#pragma once
/// Static friction as it acts on noise levels that are delta apart.

#include <optional>

#include "stickslip/model/scene.hpp"

namespace stickslip::model {

/// The largest force X + g that holds a body at rest [force]: x_k + g with the highest level
/// x_k <= mu_s - g; `backwards`: the same against motion towards negative v, of mu_s_minus. All
/// mu_s from x_k + g up to x_k + g + delta act alike. Nothing where it is the coefficient given,
/// and where the levels are given by themselves (telegraph, file).
[[nodiscard]] std::optional<double> effective_mu_s(const Scene& scene, bool backwards);

}  // namespace stickslip::model
