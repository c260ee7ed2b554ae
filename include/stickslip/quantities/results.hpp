#pragma once
/// Named results with their errors.

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stickslip/base/uncertain.hpp"
#include "stickslip/case/entry.hpp"
#include "stickslip/model/observable.hpp"

namespace stickslip::quantities {

using cases::Kind;
using cases::Row;
using stickslip::kNoValue;
using stickslip::Uncertain;

/// A scalar (no abscissa, one value) or an array over an abscissa.
struct Result {
  std::string key;            ///< name in table, JSON and HDF5
  std::string unit;           ///< empty for pure numbers
  std::string abscissa_name;  ///< empty for a scalar
  std::vector<double> abscissa;
  std::vector<double> value;
  std::vector<double> error;  ///< absolute error estimates, one for each value
  Kind kind = Kind::other;
  /// Whether accuracy is meant relative to each value of an array, not to the largest one.
  bool each_by_its_size = false;
  /// Whether accuracy of small probabilities P(x <= d) and P(x > d) is meant relative to these.
  bool tails_by_their_size = false;
  /// Whether its error decides nothing: it shows how good others are and was not asked for, or it
  /// is the derivative of another one that decides.
  bool diagnostic = false;
  /// What limits its error where no finer discretisation lowers it, in words; else empty.
  std::string limited_by = {};
  /// Of a derivative dA/dp: |A/p|. Where it has no digit, and less than 1e-6 of that for its error,
  /// it is 0 as far as it matters, and judged by this size.
  double scale = 0;
  /// Why entries that are not numbers have no value, which leaves the others as they are: "is too
  /// rare". Empty where all are to be numbers.
  std::string unreached = {};
  /// 95 % confidence intervals, one for each value; none for deterministic results.
  std::vector<std::pair<double, double>> ci95 = {};

  [[nodiscard]] bool is_scalar() const { return abscissa_name.empty(); }
};

using Results = std::vector<Result>;

/// A number by which a solution method can be judged.
struct Check {
  std::string name;
  double value = 0;
  std::string_view meaning = {};  ///< in words
};

/// A result of a row of the catalogue, without abscissa and values; of one that stands for many
/// results, that of the observable `f`.
[[nodiscard]] Result blank(const Row& row);
[[nodiscard]] Result blank(const Row& row, const model::Observable& f);

/// A scalar, or an array without values yet, made from a blank.
[[nodiscard]] Result scalar(Result blank, double value, double error);
[[nodiscard]] Result array(Result blank, std::vector<double> abscissa);

[[nodiscard]] inline Result scalar(const Row& row, double value, double error) {
  return scalar(blank(row), value, error);
}
[[nodiscard]] inline Result scalar(Result blank, Uncertain value) {
  return scalar(std::move(blank), value.value, value.error);
}
[[nodiscard]] inline Result scalar(const Row& row, Uncertain value) {
  return scalar(blank(row), value);
}
[[nodiscard]] inline Result array(const Row& row, std::vector<double> abscissa) {
  return array(blank(row), std::move(abscissa));
}
/// Of a row that stands for one array for each time or speed.
[[nodiscard]] Result array_at(const Row& row, double at, std::vector<double> abscissa);

inline void append_value(Result& array, Uncertain value) {
  array.value.push_back(value.value);
  array.error.push_back(value.error);
}

/// Appends an array with these values to the results.
inline void append_array(Result array, const std::vector<Uncertain>& values, Results& results) {
  for (const auto& value : values) append_value(array, value);
  results.push_back(std::move(array));
}

/// A number that something has changed by as much as it may be wrong.
[[nodiscard]] inline Uncertain changed_from(double before, double value) {
  return {value, std::abs(value - before)};
}

/// The largest absolute value; 0 where there is none.
[[nodiscard]] double largest_size(const std::vector<double>& values);
/// The least of the values above 0; infinity where there is none.
[[nodiscard]] double least_positive(const std::vector<double>& values);

/// A probability of P(x <= d) or P(x > d) below this one is small; below the other one so small
/// that no more is asked of it.
inline constexpr double kTail = 0.02, kLeastTail = 1e-12;

/// What errors of a value are compared with where it is compared with others: its size, or the
/// smaller one of P(x <= d) and P(x > d).
[[nodiscard]] inline double size_of(const Result& result, std::size_t n) {
  const double size = std::abs(result.value[n]);
  return result.tails_by_their_size ? std::min(size, std::abs(1 - result.value[n])) : size;
}

/// " at time = 5", of an entry of an array.
[[nodiscard]] std::string place(const Result& result, std::size_t n);
/// Whether this entry has no value, with a reason.
[[nodiscard]] bool is_unreached(const Result& result, std::size_t n);
/// Largest error relative to the size of the values; infinite where one is not a number without a
/// reason.
[[nodiscard]] double relative_error(const Result& result);
/// Whether its entries are of relaxation modes.
[[nodiscard]] inline bool over_modes(const Result& result) {
  return result.abscissa_name == "mode";
}
/// Whether no value is NaN.
[[nodiscard]] bool all_numbers(const Result& result);
/// " at tilt = 5", of the first entry of an array of which nothing is known: it is no number, or
/// has an infinite error. Empty without any.
[[nodiscard]] std::string where_unknown(const Result& result);

}  // namespace stickslip::quantities
