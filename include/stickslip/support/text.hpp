#pragma once
/// Small text helpers for messages and tables.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip {

/// The candidate with the smallest edit distance to `word`; empty when none is close enough to be
/// a plausible slip (more than a third of the letters differ).
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       std::span<const std::string> candidates);

/// Parts between separators, without surrounding blanks; "" gives no parts.
[[nodiscard]] std::vector<std::string> split(std::string_view text, char separator);

/// "a, b or c".
[[nodiscard]] std::string enumerate(std::span<const std::string> words,
                                    std::string_view conjunction);

/// `text` broken into lines of at most `width` characters, each after the first indented.
[[nodiscard]] std::string wrap(std::string_view text, std::size_t width, std::size_t indent);

}  // namespace stickslip
