#pragma once
/// The one table of results: every key that a summary can hold, what it means and in which unit.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stickslip/options/case.hpp"

namespace stickslip::options {

/// A result of a quantity. A key may stand for many: f is an observable, as in pi(f), A a scalar
/// and p a parameter, as in dA_dp.
struct ResultRow {
  std::string key;
  Quantity quantity;       ///< that gives it
  std::string symbol;      ///< in the formulas of the model, in ASCII
  std::string definition;  ///< one line
  std::string unit;        ///< empty for pure numbers; [f] is the unit of the observable f
  std::string abscissa;    ///< of an array; empty for a scalar
  std::string convention;  ///< normalisation, sign, start; may be empty
  std::string paper;       ///< equations or sections of the paper; empty if it is beyond the paper
  /// Solution methods that give the quantity but not this result.
  std::vector<Route> without = {};
  /// Whether it stands for its quantity in a file to compare with, where -quantities is not given.
  bool asks = false;

  /// Whether the key stands for the results of many observables or parameters.
  [[nodiscard]] bool is_pattern() const;
};

/// All results, in the order of their quantities.
[[nodiscard]] std::span<const ResultRow> result_table();

/// The row of a key as written, such as pi(v^2|stick) or dP_stick_dtau; nullptr if no quantity
/// gives such a result.
[[nodiscard]] const ResultRow* find_result(std::string_view key);

/// Unit of a result; empty for pure numbers, and for functions of an observable, whose unit the
/// program does not know. Throws std::logic_error for a key that is not in the table.
[[nodiscard]] std::string unit_of(std::string_view key);

/// Name of the abscissa of an array. Throws std::logic_error for a key that is not in the table.
[[nodiscard]] std::string abscissa_of(std::string_view key);

}  // namespace stickslip::options
