#pragma once
/// Small text helpers for messages and tables.

#include <optional>
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

/// Words of a line as a shell takes them: blanks separate, and what stands in quotes of either kind
/// is taken as it is. Nothing if a quote is not closed.
[[nodiscard]] std::optional<std::vector<std::string>> quoted_words(std::string_view line);

/// "a, b or c".
[[nodiscard]] std::string enumerate(std::span<const std::string> words,
                                    std::string_view conjunction);

/// `text` broken into lines of at most `width` characters, each after the first indented.
[[nodiscard]] std::string wrap(std::string_view text, std::size_t width, std::size_t indent);

}  // namespace stickslip
