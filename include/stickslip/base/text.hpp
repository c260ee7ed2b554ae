#pragma once
/// Small text helpers for messages and tables.

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip {

// The double without an end.

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

// Numbers as tables print them, and as users write them.

/// `value` down to the decimal place of the leading digit of its absolute error as "{:.1e}" prints
/// that: 0.15648616853236219 with error 3.0e-10 is "0.1564861685". At least one significant digit
/// stays; values that are known to the last bit (error 0, or rounding beyond the 16th digit) come
/// in the shortest form that reads back.
[[nodiscard]] std::string number_text(double value, double error);

/// An absolute or relative error: two digits, "0" for none, "-" for one that is not finite.
[[nodiscard]] std::string error_text(double error);

/// Seconds to the millisecond, of long times fewer decimals.
[[nodiscard]] std::string seconds_text(double seconds);

/// A finite decimal number that fills the whole text.
[[nodiscard]] std::optional<double> parse_number(const std::string& text);

/// a,b,c as they are, first:last:count evenly spaced, first:last:count:log evenly in the logarithm.
[[nodiscard]] std::optional<std::vector<double>> parse_numbers(const std::string& text);

// Files to read.

/// Throws std::invalid_argument unless it is a regular file that can be read.
void require_readable(const std::string& file);

}  // namespace stickslip
