#include "stickslip/quantities/results.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stickslip::quantities {
namespace {

double largest(const std::vector<double>& values) {
  double size = 0;
  for (double v : values) size = std::fmax(size, std::abs(v));
  return size;
}

// The unit of an observable is not known.
Result empty(const Row& row, std::string key) {
  return {.key = std::move(key),
          .unit = row.is_pattern() ? "" : std::string(row.unit),
          .abscissa_name = std::string(row.abscissa),
          .abscissa = {},
          .value = {},
          .error = {},
          .kind = row.kind,
          .each_by_its_size = row.each_by_its_size};
}

Result scalar_of(Result result, double value, double error) {
  result.value = {value};
  result.error = {error};
  return result;
}

Result array_of(Result result, std::vector<double> abscissa) {
  result.abscissa = std::move(abscissa);
  return result;
}

}  // namespace

Result scalar(const Row& row, double value, double error) {
  return scalar_of(empty(row, std::string(row.key)), value, error);
}

Result scalar(const Row& row, const std::string& f, double value, double error) {
  return scalar_of(empty(row, row.key_of(f)), value, error);
}

Result array(const Row& row, std::vector<double> abscissa) {
  return array_of(empty(row, std::string(row.key)), std::move(abscissa));
}

Result array(const Row& row, const std::string& f, std::vector<double> abscissa) {
  return array_of(empty(row, row.key_of(f)), std::move(abscissa));
}

double relative_error(const Result& result) {
  const double size = largest(result.value);
  double relative = 0;
  for (std::size_t n = 0; n < result.value.size(); ++n) {
    if (result.partial && std::isnan(result.value[n])) continue;
    const bool number = !std::isnan(result.value[n]) && !std::isnan(result.error[n]);
    if (!number) return std::numeric_limits<double>::infinity();
    if (result.error[n] == 0) continue;
    const double own = result.each_by_its_size ? std::abs(result.value[n]) : size;
    relative = std::max(relative, result.error[n] / own);
  }
  return relative;
}

}  // namespace stickslip::quantities
