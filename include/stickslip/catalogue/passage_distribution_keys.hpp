#pragma once
/// The quantities passage_transform and passage_distribution: Laplace transform, density and
/// distribution function of the time until a speed is first reached from -start.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kPassageTransform{
    .key = "F_passage(w)",
    .symbol = "E[exp(-lambda T)]",
    .definition = "Laplace transform of the first-passage time of V to the speed w from the state "
                  "of -start",
    .abscissa = "lambda",
    .convention = "for each -velocity; 1 at lambda = 0; T = 0 for stationary starts beyond w",
    .kind = Kind::transform,
    .each_by_its_size = true,
    .asks = true};
inline constexpr Row kPassageDensity{
    .key = "f_passage(w)",
    .symbol = "f(t)",
    .definition = "probability density of the first-passage time of V to the speed w from the "
                  "state of -start",
    .unit = "1/time",
    .abscissa = "time",
    .convention = "for each -velocity; without starts beyond w; monte_carlo: average over a cell",
    .by_cells = true,
    .asks = true};
inline constexpr Row kPassageCdf{
    .key = "cdf_passage(w)",
    .symbol = "P(T <= t)",
    .definition = "distribution function of the first-passage time of V to the speed w from the "
                  "state of -start",
    .abscissa = "time",
    .convention = "for each -velocity; at t = 0 the probability of a start beyond w",
    .kind = Kind::distribution,
    .asks = true};

inline constexpr const Row* kPassageTransformRows[] = {&kPassageTransform};
inline constexpr const Row* kPassageDistributionRows[] = {&kPassageDensity, &kPassageCdf};

inline constexpr Entry kPassageTimeTransform{
    .quantity = own_quantity("passage_transform"),
    .word = "passage_transform",
    .synonyms = "F_passage, passage_laplace",
    .title = "Laplace transform of the time until V first reaches a speed from -start",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "lambda, velocity, start, passage",
    .rows = kPassageTransformRows,
    .weighs_tail = true,
    .both_branches = true};
inline constexpr Entry kPassageTimeDistribution{
    .quantity = own_quantity("passage_distribution"),
    .word = "passage_distribution",
    .synonyms = "passage_density, passage_cdf, first_passage_density, first_passage_distribution",
    .title = "density and distribution function of the time until V first reaches a speed from "
             "-start",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "time, velocity, start, passage",
    .rows = kPassageDistributionRows,
    .degrees_besides = 3,
    .usual_accuracy = 1e-4,
    .weighs_tail = true,
    .both_branches = true};

}  // namespace stickslip::catalogue
