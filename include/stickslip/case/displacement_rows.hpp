#pragma once
/// The quantities of the displacement, their keys and arguments: mean and variance, transform,
/// distribution, large deviations.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

// The quantity displacement: mean and variance of the displacement from -start.

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
                                     .degrees_besides = 0,
                                     .of_travel = true};

// The quantity displacement_transform: characteristic function of the displacement.

inline constexpr Argument kWavenumber{.option = "wavenumber",
                                      .unit = "1/(velocity*time)",
                                      .sentence = "wavenumbers k",
                                      .example = "0.5,1,2",
                                      .synonyms = "wavenumbers, wave_number"};

inline constexpr Row kDisplacementCosine{
    .key = "displacement_cosine(t)",
    .symbol = "Re E[exp(i k x(t))]",
    .definition = "real part of the characteristic function of the displacement from -start",
    .abscissa = "wavenumber",
    .convention = "1 at k = 0; for each -time",
    .asks = true};
inline constexpr Row kDisplacementSine{
    .key = "displacement_sine(t)",
    .symbol = "Im E[exp(i k x(t))]",
    .definition = "imaginary part of the characteristic function of the displacement from -start",
    .abscissa = "wavenumber",
    .convention = "0 at k = 0; for each -time",
    .asks = true};

inline constexpr const Row* kDisplacementTransformRows[] = {&kDisplacementCosine,
                                                            &kDisplacementSine};
inline constexpr const Argument* kDisplacementTransformArguments[] = {&kWavenumber};

inline constexpr Entry kDisplacementTransform{
    .quantity = own_quantity("displacement_transform"),
    .word = "displacement_transform",
    .synonyms = "characteristic_function, intermediate_scattering_function, isf",
    .title = "characteristic function of the displacement from -start",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time, start",
    .arguments = kDisplacementTransformArguments,
    .rows = kDisplacementTransformRows,
    .of_travel = true,
    .weighs_tail = true,
    .both_branches = true};

// The quantity displacement_distribution: density, distribution function and quantiles of the
// displacement.

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
    .of_travel = true,
    .weighs_tail = true,
    .both_branches = true};

// The quantity large_deviation: how E[exp(s x(t))] grows, and how rare mean velocities are.

inline constexpr Argument kTilt{.option = "tilt",
                                .unit = "1/(velocity*time)",
                                .sentence = "weights s of either sign in E[exp(s x(t))]",
                                .example = "-0.5,0.2,0.5,1",
                                .synonyms = "tilts, counting_field, bias_field"};

inline constexpr Row kTheta{.key = "theta",
                            .symbol = "lim log E[exp(s x(t))]/t",
                            .definition =
                                "rate at which E[exp(s x(t))] grows: the largest eigenvalue of "
                                "L + s v, the scaled cumulant generating function",
                            .unit = "1/time",
                            .abscissa = "tilt",
                            .convention = "theta(0) = 0, theta'(0) = E_V, theta''(0) = S_0",
                            .asks = true};
inline constexpr Row kTiltedVelocity{
    .key = "tilted_velocity",
    .symbol = "theta'(s)",
    .definition = "mean velocity at which the weight exp(s x(t)) has its bulk",
    .unit = "velocity",
    .abscissa = "tilt",
    .convention = "rises with s; E_V at 0",
    .asks = true};
inline constexpr Row kRateFunction{
    .key = "rate_function",
    .symbol = "I(theta'(s)) = s theta'(s) - theta(s)",
    .definition = "rate at which the probability of that mean velocity over a time t falls",
    .unit = "1/time",
    .abscissa = "tilt",
    .convention = "log P(x(t)/t near u) is about -I(u) t; >= 0",
    .asks = true};

inline constexpr const Row* kLargeDeviationRows[] = {&kTheta, &kTiltedVelocity, &kRateFunction};
inline constexpr const Argument* kLargeDeviationArguments[] = {&kTilt};

inline constexpr Entry kLargeDeviation{
    .quantity = own_quantity("large_deviation"),
    .word = "large_deviation",
    .synonyms = "large_deviations, ldf, scgf, cumulant_generating_function, cumulants",
    .title = "growth of E[exp(s x(t))], and the rate function of the mean velocity",
    .routes = {Route::excursion},
    .arguments = kLargeDeviationArguments,
    .rows = kLargeDeviationRows,
    .degrees_besides = 4,
    .of_travel = true,
    .unbounded = "E[exp(s x(t))] grows faster than any exp(theta t), as a body that is once fast "
                 "travels far: theta is infinite for s != 0",
    .instead = "take displacement and diffusivity, or a drag that grows",
    .weighs_tail = true,
    .both_branches = true};

}  // namespace stickslip::cases
