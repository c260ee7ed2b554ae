#include "stickslip/quantities/results.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stickslip::quantities {
namespace {

double largest(const std::vector<double>& values) {
  double size = 0;
  for (double v : values) size = std::fmax(size, std::abs(v));
  return size;
}

}  // namespace

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
