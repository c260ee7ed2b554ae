#pragma once
/// The quantities of speeds that are reached, their keys and arguments: peaks, first passages and
/// their distributions.

#include "stickslip/case/entry.hpp"

namespace stickslip::cases {

// The quantity peak: largest speed of a sliding phase, mean first-passage times of |V|.

inline constexpr Row kPPeak{.key = "P_peak",
                            .symbol = "P(max|V| > w)",
                            .definition = "probability that a sliding phase exceeds the speed w",
                            .abscissa = "velocity",
                            .convention = "average per excursion",
                            .kind = Kind::probability,
                            .each_by_its_size = true,
                            .asks = true};
inline constexpr Row kFirstPassage{
    .key = "mean_first_passage",
    .symbol = "E[inf{t: |V_t| = w}]",
    .definition = "mean first-passage time of the speed to w, from the start of a sliding phase",
    .unit = "time",
    .abscissa = "velocity",
    .convention = "sticking phases on the way count",
    .kind = Kind::positive_mean,
    .each_by_its_size = true,
    .asks = true};
inline constexpr Row kFirstPassageRest{.key = "mean_first_passage_rest",
                                       .symbol = "E[inf{t: |V_t| = w}]",
                                       .definition =
                                           "mean first-passage time of the speed to w, from V = 0 "
                                           "with X in its stationary distribution",
                                       .unit = "time",
                                       .abscissa = "velocity",
                                       .convention = "as with -start rest",
                                       .kind = Kind::positive_mean,
                                       .each_by_its_size = true,
                                       .asks = true};

inline constexpr const Row* kPeakRows[] = {&kPPeak, &kFirstPassage, &kFirstPassageRest};

inline constexpr Entry kPeak{
    .quantity = Quantity::peak,
    .word = "peak",
    .synonyms = "largest_speed",
    .title = "largest speed of a sliding phase, mean first-passage times of |V|",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "velocity",
    .rows = kPeakRows,
    .of_phases = true,
    .weighs_tail = true};

// The quantity first_passage: the time until a speed is first reached from -start.

inline constexpr Row kPassageMean{
    .key = "first_passage_mean",
    .symbol = "E[T], T = inf{t: |V_t| >= w}",
    .definition = "mean first-passage time of V to the speed w from the state of -start",
    .unit = "time",
    .abscissa = "velocity",
    .convention = "as -passage says of |V|, V or -V; a stationary start beyond w counts as 0",
    .kind = Kind::positive_mean,
    .each_by_its_size = true,
    .asks = true};
inline constexpr Row kPassageVariance{
    .key = "first_passage_variance",
    .symbol = "Var T",
    .definition = "variance of the first-passage time of V to the speed w from the state of -start",
    .unit = "time^2",
    .abscissa = "velocity",
    .convention = "about its mean, over starts and paths",
    .kind = Kind::positive_mean,
    .each_by_its_size = true,
    .asks = true};

inline constexpr const Row* kFirstPassageRows[] = {&kPassageMean, &kPassageVariance};

inline constexpr Entry kFirstPassageTime{
    .quantity = own_quantity("first_passage"),
    .word = "first_passage",
    .synonyms = "fpt, mfpt, passage, exit_time, hitting_time",
    .title = "mean and variance of the time until V first reaches a speed from -start",
    .routes = {Route::excursion, Route::monte_carlo},
    .options = "velocity, start, passage",
    .rows = kFirstPassageRows,
    .weighs_tail = true,
    .both_branches = true};

// The quantities passage_transform and passage_distribution: Laplace transform, density and
// distribution function of the time until a speed is first reached from -start.

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

}  // namespace stickslip::cases
