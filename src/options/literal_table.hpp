#pragma once
/// Tables that stand in the sources as text, one row a line.

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip::options {

/// The cells of each row, which " | " separates; - stands for an empty cell, and blank lines for
/// nothing. Throws std::logic_error for a row with another number of cells.
[[nodiscard]] std::vector<std::vector<std::string>> rows_of(std::string_view table,
                                                            std::size_t columns);

}  // namespace stickslip::options
