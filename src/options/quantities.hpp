#pragma once
/// The table of quantities: how each is asked for, what gives it, and what it needs.

#include <optional>
#include <string>
#include <vector>

#include "stickslip/options/case.hpp"
#include "stickslip/options/result_table.hpp"

namespace stickslip::options {

/// A quantity that can be asked for.
struct QuantityRow {
  std::string word;  ///< of -quantities
  Quantity quantity;
  std::string title;                 ///< what it is, in half a line
  std::vector<Route> routes;         ///< that give it, for every scene
  std::vector<std::string> options;  ///< that it depends on
  std::vector<std::string> others;   ///< keys of other quantities that come with it
  bool of_one_run;                   ///< a field or a path, which has no place in a sweep
};

/// Why a route does not give the quantities that it does not give.
[[nodiscard]] const char* limit_of(Route route);

/// All quantities, in the order of the help text.
[[nodiscard]] const std::vector<QuantityRow>& quantity_table();

/// Keys of the results of a quantity, those of other quantities that come with it included.
[[nodiscard]] std::vector<std::string> keys_of(const QuantityRow& row);

/// The quantity that a result of that name asks for in a file to compare with, if any.
[[nodiscard]] std::optional<Quantity> asked_by(const std::string& key);

/// Whether anything asked for depends on the option (a name without dash).
[[nodiscard]] bool depends_on(const Question& question, const std::string& option);

}  // namespace stickslip::options
