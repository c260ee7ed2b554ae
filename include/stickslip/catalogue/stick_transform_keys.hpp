#pragma once
/// The quantity F_stick: Laplace transform of the sticking duration alone, without a solve for each
/// lambda.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Entry kStickTransform{
    .quantity = Quantity::stick_duration_transform,
    .word = "F_stick",
    .title = "Laplace transform of the sticking duration alone, without a solve for each lambda",
    .routes = {Route::excursion, Route::fluid_queue, Route::monte_carlo},
    .options = "lambda",
    .others = "F_stick",
    .of_phases = true};

}  // namespace stickslip::catalogue
