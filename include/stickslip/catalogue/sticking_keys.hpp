#pragma once
/// The quantity sticking: probability of sticking, mean durations of the phases.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kPStick{.key = "P_stick",
                             .symbol = "P_stick",
                             .definition = "probability of sticking: share of the time at rest",
                             .convention = "average per time",
                             .paper = "(4.5), (4.6), S^1 in (5.1)",
                             .kind = Kind::share,
                             .asks = true};
inline constexpr Row kPSlide{
    .key = "P_slide",
    .symbol = "1 - P_stick",
    .definition = "share of the time in sliding phases, computed without the subtraction",
    .convention = "average per time",
    .paper = "(4.10)",
    .kind = Kind::share,
    .asks = true};
inline constexpr Row kMeanStick{.key = "mean_stick",
                                .symbol = "E_exc[T_stick]",
                                .definition = "mean duration of a sticking phase",
                                .unit = "time",
                                .convention = "average per excursion",
                                .paper = "(4.6)",
                                .kind = Kind::positive_mean,
                                .without = {Route::lambda},
                                .asks = true};
inline constexpr Row kMeanSlide{.key = "mean_slide",
                                .symbol = "E_exc[T_slide]",
                                .definition = "mean duration of a sliding phase",
                                .unit = "time",
                                .convention = "average per excursion",
                                .paper = "R^(s+) in (4.7)",
                                .kind = Kind::positive_mean,
                                .without = {Route::lambda},
                                .asks = true};
inline constexpr Row kMeanExcursion{.key = "mean_excursion",
                                    .symbol = "E_exc[T], T = T_slide + T_stick",
                                    .definition = "mean duration of an excursion",
                                    .unit = "time",
                                    .convention = "average per excursion; T is tau_1 of the paper",
                                    .paper = "Prop. 3.1, (4.8), (4.9)",
                                    .kind = Kind::positive_mean,
                                    .without = {Route::lambda},
                                    .asks = true};

inline constexpr const Row* kStickingRows[] = {&kPStick, &kPSlide, &kMeanStick, &kMeanSlide,
                                               &kMeanExcursion};

inline constexpr Entry kSticking{.quantity = Quantity::sticking,
                                 .word = "sticking",
                                 .synonyms = "stick, mean_durations",
                                 .title = "probability of sticking, mean durations of the phases",
                                 .routes = {Route::excursion, Route::lambda, Route::hitting,
                                            Route::null_vector, Route::fluid_queue,
                                            Route::monte_carlo},
                                 .rows = kStickingRows,
                                 .of_phases = true};

}  // namespace stickslip::catalogue
