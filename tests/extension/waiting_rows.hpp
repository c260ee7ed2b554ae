#pragma once
/// The quantity waiting: mean time from any moment to the next start of a sliding phase.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

inline constexpr Row kMeanWaiting{
    .key = "mean_waiting",
    .symbol = "E_exc[T^2]/(2 E_exc[T])",
    .definition = "mean time from any moment to the next start of a sliding phase",
    .unit = "time",
    .convention = "average per time",
    .kind = Kind::positive_mean,
    .asks = true};

inline constexpr const Row* kWaitingRows[] = {&kMeanWaiting};

inline constexpr Entry kWaiting{.quantity = own_quantity("waiting"),
                                .word = "waiting",
                                .title = "mean time to the next start of a sliding phase",
                                .routes = {Route::excursion, Route::monte_carlo},
                                .rows = kWaitingRows,
                                .of_phases = true};

}  // namespace stickslip::cases
