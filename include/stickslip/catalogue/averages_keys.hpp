#pragma once
/// The quantity averages: stationary averages of functions of the state, overall and by phase.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kPi{.key = "pi(f)",
                         .symbol = "pi(f) = E[f(Z)]",
                         .definition = "stationary average of each observable f of -observable",
                         .unit = "[f]",
                         .convention = "average per time; Z = (X, Y, V)",
                         .paper = "(3.17), (4.1)",
                         .kind = Kind::drift,
                         .is_mean_of_f = true};
inline constexpr Row kPiStick{.key = "pi(f|stick)",
                              .symbol = "E[f(Z) given Y = 0]",
                              .definition = "average of f over the time at rest",
                              .unit = "[f]",
                              .convention = "average per time at rest",
                              .kind = Kind::drift,
                              .is_mean_of_f = true};
inline constexpr Row kPiSlide{.key = "pi(f|slide)",
                              .symbol = "E[f(Z) given Y != 0]",
                              .definition = "average of f over the time in sliding phases",
                              .unit = "[f]",
                              .convention = "average per time in motion",
                              .kind = Kind::drift,
                              .is_mean_of_f = true};
inline constexpr Row kSlipRate{.key = "slip_rate",
                               .symbol = "1/E_exc[T]",
                               .definition = "mean number of sliding phases per unit time",
                               .unit = "1/time",
                               .convention = "average per time",
                               .kind = Kind::positive_mean,
                               .without = {Route::lambda},
                               .asks = true};
inline constexpr Row kFrictionPower{.key = "friction_power",
                                    .symbol = "E[F|V|]",
                                    .definition =
                                        "mean power dissipated by dry friction, per unit mass",
                                    .unit = "force*velocity",
                                    .convention = "average per time",
                                    .kind = Kind::positive_mean,
                                    .asks = true};

inline constexpr const Row* kAveragesRows[] = {&kPi, &kPiStick, &kPiSlide, &kSlipRate,
                                               &kFrictionPower};

inline constexpr Entry kAverages{
    .quantity = Quantity::averages,
    .word = "averages",
    .title = "stationary averages of functions of the state, overall and by phase",
    .routes = {Route::excursion, Route::lambda, Route::null_vector, Route::monte_carlo},
    .options = "observable",
    .rows = kAveragesRows};

}  // namespace stickslip::catalogue
