#include "stickslip/run/estimates.hpp"

#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>

#include "stickslip/base/uncertain.hpp"

namespace stickslip::run {
namespace {

using quantities::Kind;
using quantities::place;
using quantities::Result;
using quantities::Results;

// Of the root mean square of relative errors of the means of a family.
constexpr double kShared = 0.65;
// A mean that changes less does not depend on the grid, as the mean duration of sticking at a
// single static level.
constexpr double kUnchanged = 1e-13;
// What the earlier change counts at least beside the last, where there may be waves.
constexpr double kEarlierOfWaves = 0.2;
// By how much more the errors of derivatives exceed their changes: they decide no status, and are
// for searches that trust them.
constexpr double kOfDerivative = 1.5;
// Of the errors of so many entries to either side.
constexpr double kOfNeighbours = 0.7;
constexpr int kReach = 2;

bool is_mean(const Result& r) {
  const bool mean = r.kind == Kind::mean || r.kind == Kind::positive_mean || r.kind == Kind::drift;
  return mean && r.is_scalar();
}

// What P_stick and P_slide are multiplied by where a mean is multiplied by its value.
double odds(const Results& results) {
  double product = 1;
  for (const auto& r : results) {
    if (r.kind == Kind::share) product *= r.value[0];
  }
  return product;
}

// Durations and functions of the velocity: two families, each with errors of one size.
bool is_duration(const Result& r) {
  return r.kind == Kind::share || r.unit == "time" || r.unit == "1/time";
}

// Root mean square of the relative errors of a family.
double shared_error(bool durations, const Changes& errors, const Results& results) {
  double squares = 0;
  int count = 0;
  for (std::size_t r = 0; r < results.size(); ++r) {
    // The drift may vanish.
    const bool gives = is_mean(results[r]) && results[r].kind != Kind::drift && errors[r][0] != 0;
    if (!gives || is_duration(results[r]) != durations) continue;
    const double relative = errors[r][0] / results[r].value[0];
    squares += relative * relative;
    ++count;
  }
  return count == 0 ? 0 : kShared * std::sqrt(squares / count);
}

ErrorPerChange factor_of(const Result& result, std::size_t entry, ErrorPerChange factor) {
  if (is_mean(result) || result.kind == Kind::share) factor.alone = 1;
  if (result.kind == Kind::spectrum && !result.is_scalar() &&
      result.abscissa[entry] >= factor.waves_from) {
    factor.alone *= factor.of_waves;
    factor.earlier = std::max(factor.earlier, kEarlierOfWaves * factor.last);
  }
  if (result.kind == Kind::derivative) factor.alone *= kOfDerivative;
  return factor;
}

void share_between_means(const ErrorPerChange& factor, const Results& results, Changes& errors) {
  const double of_velocity = shared_error(false, errors, results),
               of_time = shared_error(true, errors, results), product = odds(results);
  for (std::size_t r = 0; r < results.size(); ++r) {
    const bool share = results[r].kind == Kind::share;
    const bool derivative = results[r].kind == Kind::derivative;
    if (!is_mean(results[r]) && !share && !derivative) continue;
    double& error = errors[r][0];
    const double value = std::abs(results[r].value[0]);
    if (error <= kUnchanged * value) continue;
    const bool time = is_duration(results[r]);
    const double own = time ? of_time : of_velocity, other = time ? of_velocity : of_time;
    const double relative = derivative
                                ? factor_of(results[r], 0, factor).alone * std::max(own, other)
                                : std::max(own, factor.of_other_family * other);
    error = std::hypot(error, relative * (share ? product : value));
  }
}

void limit_fall(const ErrorPerChange& factor, const Results& coarse, const Results& results,
                Changes& errors) {
  for (std::size_t r = 0; r < results.size(); ++r) {
    if (!is_mean(results[r]) && results[r].kind != Kind::share) continue;
    const double least = coarse[r].error[0] / factor.most_fall;
    if (std::isfinite(least)) errors[r][0] = std::max(errors[r][0], least);
  }
}

void share_between_neighbours(std::vector<double>& errors, const Result& result) {
  if (result.is_scalar() || quantities::over_modes(result)) return;
  const std::vector<double> own = errors;
  const int count = static_cast<int>(own.size());
  for (int e = 0; e < count; ++e) {
    const double value = quantities::size_of(result, e);
    for (int other = std::max(0, e - kReach); other <= std::min(count - 1, e + kReach); ++other) {
      const double size = quantities::size_of(result, other);
      const double ratio = value < size ? value / size : 1;
      errors[e] = std::max(errors[e], kOfNeighbours * ratio * own[other]);
    }
  }
}

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
  std::ranges::sort(order, {}, [&](std::size_t n) { return result.abscissa[n]; });
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

constexpr double kFamilyLevel = 1e-3;

// The entry of `results` that the reference is about.
std::optional<Compared> counterpart(const cases::Reference& reference,
                                    const quantities::Results& results) {
  for (const auto& result : results) {
    if (result.key != reference.quantity) continue;
    if (result.is_scalar() == reference.argument.has_value()) continue;
    const auto* row = cases::find_row(result.key);
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
  std::ranges::sort(order, std::greater<>(), [&](std::size_t n) { return std::abs(rows[n].z); });
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

void require_least_error(double least, Results& results) {
  for (auto& result : results) {
    for (std::size_t e = 0; e < result.value.size(); ++e) {
      result.error[e] = std::max(result.error[e], least * quantities::size_of(result, e));
    }
  }
}

void doubt_without_digit(double digit, Result& result) {
  for (std::size_t e = 0; e < result.value.size(); ++e) {
    const double size = std::abs(result.value[e]);
    if (result.error[e] > digit * size) result.error[e] = std::max(result.error[e], size);
  }
}

Changes add_discretisation(const ErrorPerChange& factor, const Results& coarse,
                           const Changes& before, Results& results) {
  Changes changes(results.size()), errors(results.size());
  for (std::size_t r = 0; r < results.size(); ++r) {
    const auto& value = results[r].value;
    for (std::size_t e = 0; e < value.size(); ++e) {
      // A mode that the coarser grid did not find is all change.
      const double last = e < coarse[r].value.size() ? coarse[r].value[e] : 0;
      changes[r].push_back(std::abs(value[e] - last));
    }
  }
  for (std::size_t r = 0; r < results.size(); ++r) {
    for (std::size_t e = 0; e < changes[r].size(); ++e) {
      const auto of = factor_of(results[r], e, factor);
      const bool known = r < before.size() && e < before[r].size();
      const double both =
          std::hypot(of.last * changes[r][e], known ? of.earlier * before[r][e] : 0);
      errors[r].push_back(of.alone * both);
    }
  }
  share_between_means(factor, results, errors);
  if (!before.empty()) limit_fall(factor, coarse, results, errors);
  for (std::size_t r = 0; r < results.size(); ++r) {
    share_between_neighbours(errors[r], results[r]);
    for (std::size_t e = 0; e < errors[r].size(); ++e) results[r].error[e] += errors[r][e];
  }
  return changes;
}

std::string broken_bound(const quantities::Results& results) {
  for (const auto& result : results) {
    std::string broken = broken_by(result);
    if (!broken.empty()) return broken;
  }
  return "";
}

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

}  // namespace stickslip::run
