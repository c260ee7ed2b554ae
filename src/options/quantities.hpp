#pragma once
/// The table of quantities: how each is asked for, what gives it, and what it needs.

#include <optional>
#include <string>
#include <vector>

#include "stickslip/options/case.hpp"

namespace stickslip::options {

/// A quantity that can be asked for.
struct QuantityRow {
  const char* word;  ///< of -quantities
  Quantity quantity;
  std::vector<Route> routes;         ///< that give it, for every scene
  std::vector<std::string> options;  ///< that it depends on
  bool of_one_run = false;           ///< a field or a path, which has no place in a sweep
};

/// Why a route does not give the quantities that it does not give.
[[nodiscard]] const char* limit_of(Route route);

/// All quantities, in the order of the help text.
[[nodiscard]] const std::vector<QuantityRow>& quantity_table();

/// The quantity that a result of that name asks for in a file to compare with, if any.
[[nodiscard]] std::optional<Quantity> asked_by(const std::string& key);

/// Whether anything asked for depends on the option (a name without dash).
[[nodiscard]] bool depends_on(const Question& question, const std::string& option);

/// Names of all results but derivatives and those of observables.
[[nodiscard]] std::vector<std::string> plain_keys();

/// Whether it looks like a result of an observable or a derivative: pi(v^2), dP_stick_dmu_d.
[[nodiscard]] bool is_composed_key(const std::string& key);

}  // namespace stickslip::options
