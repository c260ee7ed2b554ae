#pragma once
/// The quantity entry_law: hitting distribution at the onset of sticking.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Row kEntryLawPlus{.key = "entry_law",
                                   .symbol = "P^_k(s+)",
                                   .definition =
                                       "hitting distribution at the onset of sticking: probability "
                                       "that X = x_k when the sliding phase from s+ ends",
                                   .abscissa = "k",
                                   .convention = "sums to 1 over the levels that stick",
                                   .paper = "(4.13)",
                                   .asks = true};
inline constexpr Row kEntryLawMinus{.key = "entry_law_minus",
                                    .symbol = "P^_k(s-)",
                                    .definition =
                                        "the same as entry_law for the sliding phase from s-",
                                    .abscissa = "k",
                                    .convention = "without symmetry only"};
inline constexpr Row kFStick0{
    .key = "f_stick_0",
    .symbol = "f_stick(0+)",
    .definition = "limit of the probability density of sticking durations at t -> 0+",
    .unit = "1/time",
    .convention = "average per excursion",
    .paper = "sec. 5.3",
    .asks = true};

inline constexpr const Row* kEntryLawRows[] = {&kEntryLawPlus, &kEntryLawMinus, &kFStick0};

inline constexpr Entry kEntryLaw{
    .quantity = Quantity::entry_law,
    .word = "entry_law",
    .synonyms = "hitting, entry, onset",
    .title = "hitting distribution at the onset of sticking",
    .routes = {Route::excursion, Route::fluid_queue, Route::monte_carlo},
    .rows = kEntryLawRows,
    .degrees_besides = 2,
    .of_phases = true,
    .without_limit = true};

}  // namespace stickslip::catalogue
