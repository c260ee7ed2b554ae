#pragma once
/// The options of the model.

#include <string_view>
#include <vector>

#include "stickslip/effects/option.hpp"

namespace stickslip::effects {

/// Those of every scene, and those that the effects declare, in the order of the help text.
[[nodiscard]] const std::vector<Option>& model_options();

/// The one of that name, which exists.
[[nodiscard]] const Option& model_option(std::string_view name);

}  // namespace stickslip::effects
