#pragma once
/// The quantity phase_durations: distributions of sliding and sticking durations, without those of
/// excursions.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Entry kPhaseDurations{
    .quantity = own_quantity("phase_durations"),
    .word = "phase_durations",
    .synonyms = "slide_durations, sliding_durations, stick_durations, sticking_durations",
    .title = "duration_density without excursions, at about half the cost",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time, transient_solver",
    .others = "f_slide, cdf_slide, f_stick, cdf_stick",
    .degrees_besides = 3,
    .of_phases = true};

}  // namespace stickslip::catalogue
