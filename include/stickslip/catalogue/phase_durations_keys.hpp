#pragma once
/// The quantity phase_durations: probability densities and distribution functions of the sliding
/// and sticking durations, without those of excursions.

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
inline constexpr const Row* kPhaseDurationsRows[] = {&kDensitySlide, &kCdfSlide, &kDensityStick,
                                                     &kCdfStick};

inline constexpr Entry kPhaseDurations{
    .quantity = own_quantity("phase_durations"),
    .word = "phase_durations",
    .synonyms = "slide_durations, sliding_durations, stick_durations, sticking_durations",
    .title = "duration_density of sliding and sticking phases alone, at about half the cost",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time",
    .rows = kPhaseDurationsRows,
    .degrees_besides = 3,
    .of_phases = true};

}  // namespace stickslip::catalogue
