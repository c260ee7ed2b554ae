#pragma once
/// Named results with their errors.

#include <string>
#include <utility>
#include <vector>

namespace stickslip::quantities {

/// A scalar (no abscissa, one value) or an array over an abscissa.
struct Result {
  std::string key;            ///< name in table, JSON and HDF5
  std::string unit;           ///< empty for pure numbers
  std::string abscissa_name;  ///< empty for a scalar
  std::vector<double> abscissa;
  std::vector<double> value;
  std::vector<double> error;  ///< absolute error estimates, one for each value
  /// Whether accuracy is meant relative to each value of an array, not to the largest one.
  bool each_by_its_size = false;
  /// 95 % confidence intervals, one for each value; none for deterministic results.
  std::vector<std::pair<double, double>> ci95 = {};

  [[nodiscard]] bool is_scalar() const { return abscissa_name.empty(); }
};

using Results = std::vector<Result>;

/// A scalar result.
[[nodiscard]] inline Result scalar(std::string key, std::string unit, double value, double error) {
  return {std::move(key), std::move(unit), "", {}, {value}, {error}};
}

/// An array result without values yet.
[[nodiscard]] inline Result array(std::string key, std::string unit, std::string abscissa_name,
                                  std::vector<double> abscissa) {
  return {std::move(key), std::move(unit), std::move(abscissa_name), std::move(abscissa), {}, {}};
}

/// Largest error relative to the size of the values; infinite where one is not a number.
[[nodiscard]] double relative_error(const Result& result);

}  // namespace stickslip::quantities
