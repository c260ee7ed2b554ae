#pragma once
/// The quantity large_deviation: how E[exp(s x(t))] grows, and how rare mean velocities are.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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
    .unbounded = "E[exp(s x(t))] grows faster than any exp(theta t), as a body that is once fast "
                 "travels far: theta is infinite for s != 0",
    .instead = "take displacement and diffusivity, or a drag that grows",
    .weighs_tail = true,
    .both_branches = true};

}  // namespace stickslip::catalogue
