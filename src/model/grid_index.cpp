#include "stickslip/model/grid_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stickslip::model {
namespace {

// Quotients such as 2/(tau delta^2) carry up to three roundings of half a unit each, and their
// operands one each from decimal notation; eight units cover both, and stay far below the 1e-12
// at which two different thresholds must be distinguished.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();

}  // namespace

int floor_index(double ratio) {
  const double nearest = std::round(ratio);
  const bool is_integer = std::abs(ratio - nearest) <= kRounding * std::max(1.0, std::abs(ratio));
  const double index = is_integer ? nearest : std::floor(ratio);
  if (!(std::abs(index) < std::numeric_limits<int>::max())) {
    throw std::out_of_range("grid index does not fit an integer");
  }
  return static_cast<int>(index);
}

double snapped_difference(double a, double b) {
  const double difference = a - b;
  return std::abs(difference) <= kRounding * std::max(std::abs(a), std::abs(b)) ? 0.0 : difference;
}

}  // namespace stickslip::model
