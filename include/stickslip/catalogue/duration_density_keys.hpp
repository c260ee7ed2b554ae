#pragma once
/// The quantity duration_density: probability densities and distribution functions of the
/// durations of phases and of excursions.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kDensityExcursion{.key = "f_excursion",
                                       .symbol = "f(t)",
                                       .definition =
                                           "probability density of the duration of an excursion",
                                       .unit = "1/time",
                                       .abscissa = "time",
                                       .convention = "monte_carlo: average over a cell",
                                       .paper = "sec. 5.3",
                                       .by_cells = true,
                                       .asks = true};
inline constexpr Row kCdfExcursion{.key = "cdf_excursion",
                                   .symbol = "P(T <= t)",
                                   .definition =
                                       "distribution function of the duration of an excursion",
                                   .abscissa = "time",
                                   .convention = "average per excursion",
                                   .kind = Kind::distribution,
                                   .asks = true};

inline constexpr const Row* kDurationDensityRows[] = {&kDensityExcursion, &kCdfExcursion};

inline constexpr Entry kDurationDensity{
    .quantity = Quantity::duration_density,
    .word = "duration_density",
    .synonyms = "durations, survival, duration_distribution",
    .title = "probability densities and distribution functions of the durations",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time",
    .others = "f_slide, cdf_slide, f_stick, cdf_stick",
    .rows = kDurationDensityRows,
    .degrees_besides = 3,
    .of_phases = true};

}  // namespace stickslip::catalogue
