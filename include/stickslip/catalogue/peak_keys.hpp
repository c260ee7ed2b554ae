#pragma once
/// The quantity peak: largest speed of a sliding phase, mean first-passage times of |V|.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

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

}  // namespace stickslip::catalogue
