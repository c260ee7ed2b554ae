#pragma once
/// Values of other origin to compare results with (-compare).

#include <string>
#include <vector>

#include "stickslip/cases/case.hpp"

namespace stickslip::outputs {

using cases::Reference;

/// Reads HDF5 or JSON written by this program (simulated or computed; errors of computed values
/// count as intervals), or CSV with a header and the columns quantity, argument, value, low, high;
/// an empty argument is a scalar, and empty bounds are no width. Histograms (f_slide, ...) of
/// simulations are left out: their distribution functions hold the same without cells. Throws
/// std::invalid_argument with what is wrong and where. Local.
[[nodiscard]] std::vector<Reference> read_references(const std::string& file);

}  // namespace stickslip::outputs
