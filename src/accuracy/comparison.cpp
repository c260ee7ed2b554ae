#include "stickslip/accuracy/comparison.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "stickslip/support/statistics.hpp"

namespace stickslip::accuracy {
namespace {

constexpr double kFamilyLevel = 1e-3;

// The entry of `results` that the reference is about.
std::optional<Compared> counterpart(const cases::Reference& reference,
                                    const quantities::Results& results) {
  for (const auto& result : results) {
    if (result.key != reference.quantity) continue;
    if (result.is_scalar() == reference.argument.has_value()) continue;
    const auto* row = catalogue::find_row(result.key);
    if (!result.ci95.empty() && row != nullptr && row->by_cells) continue;
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      const bool same = result.is_scalar() || std::abs(result.abscissa[n] - *reference.argument) <=
                                                  1e-9 * std::abs(*reference.argument);
      if (!same) continue;
      const double error =
          result.ci95.empty() ? result.error[n] : result.error[n] / kNormalQuantile;
      return Compared{reference, result.value[n], error};
    }
  }
  return std::nullopt;
}

double deviations(const Compared& c) {
  const auto& r = c.reference;
  const double difference = c.value - r.value;
  if (difference == 0) return 0;
  const double half = difference > 0 ? r.high - r.value : r.value - r.low;
  const double rounding = std::numeric_limits<double>::epsilon() * std::abs(c.value);
  // In pairs: the library's sum of three infinite squares is no number.
  return difference / std::hypot(std::hypot(half / kNormalQuantile, c.error), rounding);
}

double chance(double z) {
  const boost::math::normal normal;
  return 2 * boost::math::cdf(boost::math::complement(normal, std::min(std::abs(z), 1e3)));
}

// Holm: the smallest of m probabilities against level/m, the next against level/(m - 1), ...
void judge(Comparison& comparison) {
  auto& rows = comparison.rows;
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(rows[a].z) > std::abs(rows[b].z);
  });
  bool rejecting = true;
  for (std::size_t n = 0; n < order.size(); ++n) {
    Compared& row = rows[order[n]];
    const auto left = static_cast<double>(rows.size() - n);
    rejecting = rejecting && chance(row.z) * left < kFamilyLevel;
    if (rejecting) {
      row.verdict = Verdict::disagrees;
      comparison.disagrees = true;
    } else if (std::abs(row.z) >= kNormalQuantile) {
      row.verdict = Verdict::by_chance;
    }
  }
}

}  // namespace

const char* verdict_text(Verdict verdict) {
  switch (verdict) {
  case Verdict::agrees: return "agrees";
  case Verdict::by_chance: return "by chance";
  case Verdict::disagrees: break;
  }
  return "DISAGREES";
}

Comparison compare(const std::vector<cases::Reference>& references,
                   const quantities::Results& results) {
  Comparison comparison;
  for (const auto& reference : references) {
    auto row = counterpart(reference, results);
    if (row) {
      row->z = deviations(*row);
      comparison.rows.push_back(std::move(*row));
    } else if (auto& names = comparison.left_out;
               std::find(names.begin(), names.end(), reference.quantity) == names.end()) {
      names.push_back(reference.quantity);
    }
  }
  judge(comparison);
  return comparison;
}

}  // namespace stickslip::accuracy
