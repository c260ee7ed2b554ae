#pragma once
/// The quantity laplace: Laplace transforms and variances of the durations.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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
    .of_phases = true};

}  // namespace stickslip::catalogue
