#pragma once
/// The quantity displacement_distribution: density, distribution function and quantiles of the
/// displacement.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Argument kProbability{.option = "probability",
                                       .sentence = "probabilities between 0 and 1 of quantiles",
                                       .example = "0.05,0.5,0.95",
                                       .synonyms = "probabilities, percentile, quantile",
                                       .low = 0,
                                       .high = 1,
                                       .optional = true};

inline constexpr Row kDisplacementDensity{
    .key = "displacement_density(t)",
    .symbol = "f(d, t)",
    .definition = "probability density of the displacement from -start, without atoms",
    .unit = "1/(velocity*time)",
    .abscissa = "distance",
    .convention = "for each -time; monte_carlo: average over a cell",
    .by_cells = true,
    .asks = true};
inline constexpr Row kDisplacementCdf{.key = "displacement_cdf(t)",
                                      .symbol = "P(x(t) <= d)",
                                      .definition =
                                          "distribution function of the displacement from -start",
                                      .abscissa = "distance",
                                      .convention = "for each -time",
                                      .kind = Kind::distribution,
                                      .asks = true};
inline constexpr Row kDisplacementQuantile{.key = "displacement_quantile(t)",
                                           .symbol = "d with P(x(t) <= d) = p",
                                           .definition = "quantile of the displacement from -start",
                                           .unit = "velocity*time",
                                           .abscissa = "probability",
                                           .convention =
                                               "for each -time; that of the atom where p is in it",
                                           .asks = true};
inline constexpr Row kDisplacementAtom{
    .key = "displacement_atom",
    .symbol = "P(x(t) = d_0)",
    .definition = "probability of one displacement: of a body that has not moved yet, or has moved "
                  "without a jump of the noise",
    .abscissa = "time",
    .kind = Kind::probability,
    .without = {Route::monte_carlo}};
inline constexpr Row kDisplacementAtomAt{.key = "displacement_atom_at",
                                         .symbol = "d_0",
                                         .definition = "the displacement that has a probability",
                                         .unit = "velocity*time",
                                         .abscissa = "time",
                                         .convention = "0 but from a state of sliding",
                                         .without = {Route::monte_carlo}};

inline constexpr const Row* kDisplacementDistributionRows[] = {
    &kDisplacementDensity, &kDisplacementCdf, &kDisplacementQuantile, &kDisplacementAtom,
    &kDisplacementAtomAt};
inline constexpr const Argument* kDisplacementDistributionArguments[] = {&kProbability};

inline constexpr Entry kDisplacementDistribution{
    .quantity = own_quantity("displacement_distribution"),
    .word = "displacement_distribution",
    .synonyms = "displacement_density, displacement_cdf, displacement_quantile, van_hove",
    .title = "density, distribution function and quantiles of the displacement from -start",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time, start, distance",
    .arguments = kDisplacementDistributionArguments,
    .rows = kDisplacementDistributionRows,
    .usual_accuracy = 0.01,
    .weighs_tail = true,
    .both_branches = true};

}  // namespace stickslip::catalogue
