#pragma once
/// The quantity moments: moments of the velocity in the stationary distribution.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kEV2{.key = "E_V2",
                          .symbol = "E[V^2]",
                          .definition = "second moment of the velocity",
                          .unit = "velocity^2",
                          .convention = "about 0: Var V = E_V2 - E_V^2",
                          .paper = "S^2 in (5.1)",
                          .kind = Kind::positive_mean,
                          .asks = true};
inline constexpr Row kEAbsV{.key = "E_absV",
                            .symbol = "E[|V|]",
                            .definition = "mean speed",
                            .unit = "velocity",
                            .convention = "average per time",
                            .kind = Kind::mean,
                            .asks = true};
inline constexpr Row kEXV{.key = "E_XV",
                          .symbol = "E[X V]",
                          .definition = "mean power of the noise, per unit mass",
                          .unit = "force*velocity",
                          .convention = "X without the bias g: E[(X + g) V] = E[F|V|] - E[b(V) V]",
                          .kind = Kind::mean,
                          .asks = true};
inline constexpr Row kEV{.key = "E_V",
                         .symbol = "E[V]",
                         .definition = "mean velocity",
                         .unit = "velocity",
                         .convention = "exactly 0 with symmetry",
                         .kind = Kind::drift,
                         .asks = true};

inline constexpr const Row* kMomentsRows[] = {&kEV2, &kEAbsV, &kEXV, &kEV};

inline constexpr Entry kMoments{.quantity = Quantity::moments,
                                .word = "moments",
                                .synonyms = "variance, mean_square, energy",
                                .title = "moments of the velocity in the stationary distribution",
                                .routes = {Route::excursion, Route::lambda, Route::null_vector,
                                           Route::fluid_queue, Route::monte_carlo},
                                .rows = kMomentsRows};

}  // namespace stickslip::catalogue
