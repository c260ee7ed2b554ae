#pragma once
/// The quantity first_passage: the time until a speed is first reached from -start.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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

}  // namespace stickslip::catalogue
