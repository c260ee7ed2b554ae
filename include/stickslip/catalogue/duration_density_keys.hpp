#pragma once
/// The quantity duration_density: probability densities and distribution functions of the
/// durations.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kDensitySlide{.key = "f_slide",
                                   .symbol = "f_slide(t)",
                                   .definition = "probability density of the sliding duration",
                                   .unit = "1/time",
                                   .abscissa = "time",
                                   .convention = "monte_carlo: average over a cell",
                                   .paper = "sec. 5.3",
                                   .by_cells = true,
                                   .asks = true};
inline constexpr Row kCdfSlide{.key = "cdf_slide",
                               .symbol = "P(T_slide <= t)",
                               .definition = "distribution function of the sliding duration",
                               .abscissa = "time",
                               .convention = "average per excursion",
                               .kind = Kind::distribution,
                               .asks = true};
inline constexpr Row kDensityStick{.key = "f_stick",
                                   .symbol = "f_stick(t)",
                                   .definition = "probability density of the sticking duration",
                                   .unit = "1/time",
                                   .abscissa = "time",
                                   .convention = "monte_carlo: average over a cell",
                                   .paper = "sec. 5.3",
                                   .by_cells = true,
                                   .asks = true};
inline constexpr Row kCdfStick{.key = "cdf_stick",
                               .symbol = "P(T_stick <= t)",
                               .definition = "distribution function of the sticking duration",
                               .abscissa = "time",
                               .convention = "average per excursion",
                               .kind = Kind::distribution,
                               .asks = true};
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

inline constexpr const Row* kDurationDensityRows[] = {
    &kDensitySlide, &kCdfSlide, &kDensityStick, &kCdfStick, &kDensityExcursion, &kCdfExcursion};

inline constexpr Entry kDurationDensity{
    .quantity = Quantity::duration_density,
    .word = "duration_density",
    .synonyms = "durations, survival, duration_distribution",
    .title = "probability densities and distribution functions of the durations",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time, transient_solver",
    .rows = kDurationDensityRows,
    .degrees_besides = 3,
    .of_phases = true};

}  // namespace stickslip::catalogue
