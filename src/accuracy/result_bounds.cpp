#include "stickslip/accuracy/result_bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "stickslip/support/infinity.hpp"

namespace stickslip::accuracy {
namespace {

using quantities::Kind;
using quantities::place;
using quantities::Result;

constexpr double kRounding = 1e-10;  // where errors are smaller, they are estimates themselves

/// What a result has to keep to.
struct Bounds {
  double highest;     // the lowest is 0
  int direction = 0;  // along the abscissa: -1 falls, 1 rises, 0 either
};

std::optional<Bounds> bounds_of(Kind kind) {
  switch (kind) {
  case Kind::probability:
  case Kind::share: return Bounds{1};
  case Kind::transform: return Bounds{1, -1};
  case Kind::distribution: return Bounds{1, 1};
  case Kind::positive_mean:
  case Kind::spectrum: return Bounds{kInfinity};
  case Kind::other:
  case Kind::mean:
  case Kind::drift:
  case Kind::derivative: break;
  }
  return std::nullopt;
}

std::string out_of_range(const Result& result, double highest) {
  for (std::size_t n = 0; n < result.value.size(); ++n) {
    const double value = result.value[n], slack = result.error[n] + kRounding;
    if (quantities::is_unreached(result, n) || (value >= -slack && value <= highest + slack))
      continue;
    return fmt::format("{} is {:.9g}{}", result.key, value, place(result, n));
  }
  return "";
}

std::string wrong_way(const Result& result, int direction) {
  std::vector<std::size_t> order(result.value.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t n) { return quantities::is_unreached(result, n); });
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return result.abscissa[a] < result.abscissa[b]; });
  for (std::size_t n = 1; n < order.size(); ++n) {
    const std::size_t a = order[n - 1], b = order[n];
    const double step = direction * (result.value[b] - result.value[a]);
    if (step >= -(result.error[a] + result.error[b] + kRounding)) continue;
    return fmt::format("{} {} from {:.9g}{} to {:.9g}{}", result.key,
                       direction < 0 ? "rises" : "falls", result.value[a], place(result, a),
                       result.value[b], place(result, b));
  }
  return "";
}

std::string broken_by(const Result& result) {
  const auto bounds = bounds_of(result.kind);
  if (!bounds || !result.ci95.empty()) return "";
  std::string broken = out_of_range(result, bounds->highest);
  const bool ordered = bounds->direction != 0 && !result.is_scalar();
  if (broken.empty() && ordered) broken = wrong_way(result, bounds->direction);
  return broken;
}

}  // namespace

std::string broken_bound(const quantities::Results& results) {
  for (const auto& result : results) {
    std::string broken = broken_by(result);
    if (!broken.empty()) return broken;
  }
  return "";
}

}  // namespace stickslip::accuracy
