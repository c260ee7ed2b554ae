#pragma once
/// What the quantities asked for depend on.

#include <string>
#include <vector>

#include "stickslip/cases/case.hpp"

namespace stickslip::options {

/// The words of all quantities, in the order of the help text.
[[nodiscard]] std::vector<std::string> quantity_words();

/// Keys of the results of a quantity, those of other quantities that come with it included.
[[nodiscard]] std::vector<std::string> keys_of(const catalogue::Entry& entry);

/// Whether anything asked for depends on the option (a name without dash).
[[nodiscard]] bool depends_on(const Question& question, const std::string& option);

}  // namespace stickslip::options
