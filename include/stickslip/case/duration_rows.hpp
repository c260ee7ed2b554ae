#pragma once
/// The quantities of durations and of slips, their keys and arguments: densities and transforms.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

// The quantity duration_density: probability densities and distribution functions of the
// durations of phases and of excursions.

inline constexpr Row kDensityExcursion{.key = "f_excursion",
                                       .symbol = "f(t)",
                                       .definition =
                                           "probability density of the duration of an excursion",
                                       .unit = "1/time",
                                       .abscissa = "time",
                                       .convention = "monte_carlo: average over a cell",
                                       .paper = "sec. 5.3",
                                       .by_cells = true,
                                       .asks = true};
inline constexpr Row kCdfExcursion{.key = "cdf_excursion",
                                   .symbol = "P(T <= t)",
                                   .definition =
                                       "distribution function of the duration of an excursion",
                                   .abscissa = "time",
                                   .convention = "average per excursion",
                                   .kind = Kind::distribution,
                                   .asks = true};

inline constexpr const Row* kDurationDensityRows[] = {&kDensityExcursion, &kCdfExcursion};

inline constexpr Entry kDurationDensity{
    .quantity = Quantity::duration_density,
    .word = "duration_density",
    .synonyms = "durations, survival, duration_distribution",
    .title = "probability densities and distribution functions of the durations",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time",
    .others = "f_slide, cdf_slide, f_stick, cdf_stick",
    .rows = kDurationDensityRows,
    .degrees_besides = 3,
    .of_phases = true,
    .by_excursion = true};

// The quantity phase_durations: probability densities and distribution functions of the sliding
// and sticking durations, without those of excursions.

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
    .of_phases = true,
    .by_excursion = true};

// The quantity F_stick: Laplace transform of the sticking duration alone, without a solve for each
// lambda.

inline constexpr Entry kStickTransform{
    .quantity = Quantity::stick_duration_transform,
    .word = "F_stick",
    .title = "Laplace transform of the sticking duration alone, without a solve for each lambda",
    .routes = {Route::excursion, Route::fluid_queue, Route::monte_carlo},
    .options = "lambda",
    .others = "F_stick",
    .of_phases = true,
    .by_excursion = true};

// The quantity laplace: Laplace transforms and variances of the durations.

inline constexpr Row kTransformSlide{.key = "F_slide",
                                     .symbol = "E_exc[exp(-lambda T_slide)]",
                                     .definition = "Laplace transform of the sliding duration",
                                     .abscissa = "lambda",
                                     .convention = "1 at lambda = 0",
                                     .paper = "(4.16) to (4.19)",
                                     .kind = Kind::transform,
                                     .each_by_its_size = true,
                                     .asks = true};
inline constexpr Row kTransformStick{.key = "F_stick",
                                     .symbol = "E_exc[exp(-lambda T_stick)]",
                                     .definition = "Laplace transform of the sticking duration",
                                     .abscissa = "lambda",
                                     .convention = "1 at lambda = 0",
                                     .paper = "(4.12) to (4.15)",
                                     .kind = Kind::transform,
                                     .each_by_its_size = true,
                                     .asks = true};
inline constexpr Row kTransformExcursion{.key = "F_excursion",
                                         .symbol = "E_exc[exp(-lambda T)]",
                                         .definition =
                                             "Laplace transform of the duration of an excursion",
                                         .abscissa = "lambda",
                                         .convention = "h_plus + h_minus, with symmetry",
                                         .paper = "(3.5)",
                                         .kind = Kind::transform,
                                         .each_by_its_size = true,
                                         .asks = true};
inline constexpr Row kVarSlide{.key = "var_slide",
                               .symbol = "Var T_slide",
                               .definition = "variance of the sliding duration",
                               .unit = "time^2",
                               .convention = "average per excursion",
                               .without = {Route::fluid_queue}};
inline constexpr Row kVarStick{.key = "var_stick",
                               .symbol = "Var T_stick",
                               .definition = "variance of the sticking duration",
                               .unit = "time^2",
                               .convention = "average per excursion",
                               .without = {Route::fluid_queue}};
inline constexpr Row kVarExcursion{.key = "var_excursion",
                                   .symbol = "Var T",
                                   .definition = "variance of the duration of an excursion",
                                   .unit = "time^2",
                                   .convention = "average per excursion",
                                   .without = {Route::fluid_queue}};
inline constexpr Row kFSlide0{
    .key = "f_slide_0",
    .symbol = "f_slide(0+)",
    .definition = "limit of the probability density of sliding durations at t -> 0+",
    .unit = "1/time",
    .convention = "0 unless one jump of the noise from x_(k+1) reverses the force",
    .paper = "sec. 5.3",
    .without = {Route::fluid_queue, Route::monte_carlo}};

inline constexpr const Row* kLaplaceRows[] = {
    &kTransformSlide, &kTransformStick, &kTransformExcursion, &kVarSlide, &kVarStick,
    &kVarExcursion,   &kFSlide0};

inline constexpr Entry kLaplace{
    .quantity = Quantity::laplace,
    .word = "laplace",
    .synonyms = "transform, transforms, laplace_transform",
    .title = "Laplace transforms and variances of the durations",
    .routes = {Route::excursion, Route::fluid_queue, Route::monte_carlo},
    .options = "lambda",
    .others = "mean_slide, mean_stick, mean_excursion, f_stick_0",
    .rows = kLaplaceRows,
    .of_phases = true,
    .by_excursion = true};

// The quantity slip: path length and net displacement of a sliding phase.

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
