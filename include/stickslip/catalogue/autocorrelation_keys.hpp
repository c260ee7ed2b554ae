#pragma once
/// The quantity autocorrelation: autocovariance of the velocity.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kAutocovariance{.key = "C_vv",
                                     .symbol = "E[(V_0 - m)(V_t - m)]",
                                     .definition = "autocovariance of the velocity, m = E[V]",
                                     .unit = "velocity^2",
                                     .abscissa = "time",
                                     .convention = "stationary start; C_vv(0) = Var V",
                                     .paper = "sec. 4.2",
                                     .asks = true};

inline constexpr const Row* kAutocorrelationRows[] = {&kAutocovariance};

inline constexpr Entry kAutocorrelation{.quantity = Quantity::autocorrelation,
                                        .word = "autocorrelation",
                                        .synonyms = "acf, vacf, correlation, autocovariance",
                                        .title = "autocovariance of the velocity",
                                        .routes = {Route::excursion, Route::monte_carlo},
                                        .options = "time",
                                        .rows = kAutocorrelationRows};

}  // namespace stickslip::catalogue
