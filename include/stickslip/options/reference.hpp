#pragma once
/// Values of other origin to compare results with (-compare).

#include <optional>
#include <string>
#include <vector>

namespace stickslip::options {

/// One value with a 95 % confidence interval.
struct Reference {
  std::string quantity;            ///< key of a result, such as P_stick or S_v
  std::optional<double> argument;  ///< lambda, omega, time or k, for an array
  double value = 0, low = 0, high = 0;
};

/// Reads HDF5 or JSON written by this program (simulated or computed; errors of computed values
/// count as intervals), or CSV with a header and the columns quantity, argument, value, low, high;
/// an empty argument is a scalar, and empty bounds are no width. Histograms (f_slide, ...) of
/// simulations are left out: their distribution functions hold the same without cells. Throws
/// std::invalid_argument with what is wrong and where. Local.
[[nodiscard]] std::vector<Reference> read_references(const std::string& file);

/// Whether simulations give averages over cells for a result, not values at points.
[[nodiscard]] bool is_histogram(const std::string& key);

}  // namespace stickslip::options
