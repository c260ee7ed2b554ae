#pragma once
/// Tables that stand in the sources as text, one row a line.

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "words.hpp"

namespace stickslip::options {

/// The cells of each row, which " | " separates; - stands for an empty cell, and blank lines for
/// nothing. Throws std::logic_error for a row with another number of cells.
[[nodiscard]] std::vector<std::vector<std::string>> rows_of(std::string_view table,
                                                            std::size_t columns);

/// What a word of such a table means. Throws std::logic_error unless it is one of `all`.
template <class Value, std::size_t N>
[[nodiscard]] Value known(const Word<Value> (&all)[N], const std::string& word) {
  const auto found = std::find_if(std::begin(all), std::end(all),
                                  [&](const auto& each) { return each.word == word; });
  if (found == std::end(all)) throw std::logic_error(word + " is no word of this table");
  return found->value;
}

/// The routes of a comma list of their words.
[[nodiscard]] std::vector<Route> routes_of(std::string_view list);

}  // namespace stickslip::options
