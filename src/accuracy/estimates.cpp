#include "stickslip/accuracy/estimates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stickslip::accuracy {
namespace {

using quantities::Kind;
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
      const auto of = factor_of(results[r], e, factor);
      // A mode that the coarser grid did not find is all change.
      const double last = e < coarse[r].value.size() ? coarse[r].value[e] : 0;
      const bool known = r < before.size() && e < before[r].size();
      changes[r].push_back(std::abs(value[e] - last));
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

}  // namespace stickslip::accuracy
