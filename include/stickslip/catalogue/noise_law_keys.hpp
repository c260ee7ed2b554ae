#pragma once
/// The quantity noise_law: stationary distribution of the noise.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kPWithin{
    .key = "P_X_le_mu_s",
    .symbol = "P(|X| <= mu_s)",
    .definition =
        "probability that the noise alone is within the static threshold, in motion or at rest",
    .convention = "X without the bias, mu_s that of -mu_s",
    .paper = "S^3 in (5.1)",
    .kind = Kind::probability,
    .asks = true};
inline constexpr Row kEX2{.key = "E_X2",
                          .symbol = "E[X^2]",
                          .definition = "second moment of the noise",
                          .unit = "force^2",
                          .convention = "about 0; 1/tau for -noise ou with all levels",
                          .paper = "sec. 2",
                          .kind = Kind::positive_mean,
                          .asks = true};

inline constexpr const Row* kNoiseLawRows[] = {&kPWithin, &kEX2};

inline constexpr Entry kNoiseLaw{.quantity = Quantity::noise_law,
                                 .word = "noise_law",
                                 .title = "stationary distribution of the noise",
                                 .routes = {Route::excursion, Route::lambda, Route::null_vector,
                                            Route::fluid_queue, Route::monte_carlo},
                                 .rows = kNoiseLawRows};

}  // namespace stickslip::catalogue
