#pragma once
/// The quantity slip: path length and net displacement of a sliding phase.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

inline constexpr Row kMeanSlip{.key = "mean_slip",
                               .symbol = "E_exc[S], S = int |V| dt",
                               .definition = "mean path length of a sliding phase",
                               .unit = "velocity*time",
                               .convention =
                                   "average per excursion: E_exc[S] = E_absV mean_excursion",
                               .kind = Kind::positive_mean,
                               .asks = true};
inline constexpr Row kVarSlip{.key = "var_slip",
                              .symbol = "Var S",
                              .definition = "variance of the path length",
                              .unit = "velocity^2*time^2",
                              .convention = "average per excursion",
                              .asks = true};
inline constexpr Row kMeanSlipNet{.key = "mean_slip_net",
                                  .symbol = "E_exc[int V dt]",
                                  .definition = "mean net displacement of a sliding phase",
                                  .unit = "velocity*time",
                                  .convention = "exactly 0 with symmetry",
                                  .kind = Kind::drift,
                                  .asks = true};
inline constexpr Row kVarSlipNet{.key = "var_slip_net",
                                 .symbol = "Var int V dt",
                                 .definition = "variance of the net displacement",
                                 .unit = "velocity^2*time^2",
                                 .convention = "average per excursion",
                                 .asks = true};
inline constexpr Row kDensitySlip{.key = "f_slip",
                                  .symbol = "f_slip(d)",
                                  .definition = "probability density of the path length",
                                  .unit = "1/(velocity*time)",
                                  .abscissa = "distance",
                                  .convention = "monte_carlo: average over a cell",
                                  .by_cells = true,
                                  .asks = true};
inline constexpr Row kCdfSlip{.key = "cdf_slip",
                              .symbol = "P(S <= d)",
                              .definition = "distribution function of the path length",
                              .abscissa = "distance",
                              .convention = "average per excursion",
                              .kind = Kind::distribution,
                              .asks = true};
inline constexpr Row kTransformSlip{.key = "F_slip",
                                    .symbol = "E_exc[exp(-s S)]",
                                    .definition = "Laplace transform of the path length",
                                    .abscissa = "inverse_distance",
                                    .convention = "1 at s = 0",
                                    .kind = Kind::transform,
                                    .each_by_its_size = true};

inline constexpr const Row* kSlipRows[] = {&kMeanSlip,    &kVarSlip, &kMeanSlipNet,  &kVarSlipNet,
                                           &kDensitySlip, &kCdfSlip, &kTransformSlip};

inline constexpr Entry kSlip{.quantity = Quantity::slip,
                             .word = "slip",
                             .synonyms = "avalanche, slide_length",
                             .title = "path length and net displacement of a sliding phase",
                             .routes = {Route::excursion, Route::monte_carlo},
                             .options = "distance, inverse_distance",
                             .rows = kSlipRows,
                             .of_phases = true,
                             .by_excursion = true};

}  // namespace stickslip::cases
