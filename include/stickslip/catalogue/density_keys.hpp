#pragma once
/// The quantity density: stationary distribution as a field in the file of -output.

#include "stickslip/catalogue/entry.hpp"

namespace stickslip::catalogue {

inline constexpr Entry kDensity{
    .quantity = Quantity::density,
    .word = "density",
    .synonyms = "pdf, stationary, distribution, invariant_measure, histogram",
    .title = "stationary distribution as a field in the file of -output",
    .routes = {Route::excursion},
    .of_one_run = true};

}  // namespace stickslip::catalogue
