#pragma once
/// The quantity displacement: mean and variance of the displacement from -start.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kDisplacementMean{.key = "displacement_mean",
                                       .symbol = "E[x(t)], x(t) = int_0^t V ds",
                                       .definition = "mean displacement from the state of -start",
                                       .unit = "velocity*time",
                                       .abscissa = "time",
                                       .convention = "E[V] t with -start stationary",
                                       .asks = true};
inline constexpr Row kDisplacementVariance{
    .key = "displacement_variance",
    .symbol = "Var x(t)",
    .definition = "variance of the displacement from the state of -start",
    .unit = "velocity^2*time^2",
    .abscissa = "time",
    .convention = "about its mean; grows like 2 D t",
    .asks = true};

inline constexpr const Row* kDisplacementRows[] = {&kDisplacementMean, &kDisplacementVariance};

inline constexpr Entry kDisplacement{.quantity = Quantity::displacement,
                                     .word = "displacement",
                                     .synonyms = "msd, mean_square_displacement, diffusion",
                                     .title = "mean and variance of the displacement from -start",
                                     .routes = {Route::excursion, Route::monte_carlo},
                                     .options = "time, start",
                                     .rows = kDisplacementRows,
                                     .degrees_besides = 0};

}  // namespace stickslip::catalogue
