#pragma once
/// The quantity trajectory: a simulated path in the file of -output or -trajectory.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Entry kTrajectory{.quantity = Quantity::trajectory,
                                   .word = "trajectory",
                                   .synonyms = "path, sample_path, simulation",
                                   .title =
                                       "a simulated path in the file of -output or -trajectory",
                                   .routes = {Route::excursion, Route::monte_carlo},
                                   .options = "start, horizon, seed",
                                   .without_system = true,
                                   .of_one_run = true};

}  // namespace stickslip::catalogue
