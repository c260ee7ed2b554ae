#pragma once
/// The quantity expectation: expectations from -start (backward Kolmogorov equation).

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kExpectationOf{
    .key = "E(f)",
    .symbol = "E[f(Z_t) given Z_0]",
    .definition = "expectation of each observable f at time t, from the state of -start",
    .unit = "[f]",
    .abscissa = "time",
    .convention = "solution of the backward Kolmogorov equation",
    .paper = "(2.21), (2.22)",
    .is_mean_of_f = true};
inline constexpr Row kStationaryOf{.key = "stationary(f)",
                                   .symbol = "pi(f)",
                                   .definition = "limit of E(f) for t -> infinity",
                                   .unit = "[f]",
                                   .convention = "average per time",
                                   .paper = "(3.17)",
                                   .is_mean_of_f = true};

inline constexpr const Row* kExpectationRows[] = {&kExpectationOf, &kStationaryOf};

inline constexpr Entry kExpectation{.quantity = Quantity::expectation,
                                    .word = "expectation",
                                    .title =
                                        "expectations from -start (backward Kolmogorov equation)",
                                    .routes = {Route::excursion, Route::monte_carlo},
                                    .options = "observable, time, start",
                                    .rows = kExpectationRows};

}  // namespace stickslip::catalogue
