#pragma once
/// The one table of options: validation, help and pages are made from it.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stickslip/effects/option.hpp"

namespace stickslip::options {

using effects::Kind;
using effects::Option;
using effects::Range;

struct Group {
  std::string title;
  std::string explanation;
  std::vector<Option> options;
};

/// What is no option of the table: texts that end the run, and families of PETSc's own options.
struct OtherOption {
  std::string name;  ///< with its dash; with dots, a family
  std::string sentence;
  std::string synonyms = {};  ///< other names for it, a comma list
};

/// What a value must be, in a sentence: "a number in (0, inf)", "linear, none or cubic".
[[nodiscard]] std::string requirement(const Option& option);

/// The range or the words that its form leaves open; empty if there are none.
[[nodiscard]] std::string allowed(const Option& option);

/// The option of the model that an option sweeps; nullptr for any other option.
[[nodiscard]] const Option* swept_by(const Option& option);

/// All options by group, in the order of the help text.
[[nodiscard]] std::span<const Group> table();

/// The same without groups.
[[nodiscard]] std::span<const Option> all_options();

/// Options outside the table, in the order of the help text.
[[nodiscard]] std::span<const OtherOption> other_options();

/// The option of that name (without dash), or nullptr.
[[nodiscard]] const Option* find(std::string_view name);

/// Names with their dash, for suggestions.
[[nodiscard]] std::vector<std::string> all_names();

}  // namespace stickslip::options
