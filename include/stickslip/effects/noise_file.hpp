#pragma once
/// Noise levels from a file.

#include <string>

#include "stickslip/model/level_table.hpp"

namespace stickslip::effects {

/// The levels in a CSV file with the columns x,rate_up,rate_down. Throws std::invalid_argument with
/// the line and the value that is wrong.
[[nodiscard]] model::LevelTable read_levels(const std::string& file);

}  // namespace stickslip::effects
