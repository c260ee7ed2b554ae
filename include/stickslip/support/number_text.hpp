#pragma once
/// Numbers as tables print them, and as users write them.

#include <optional>
#include <string>
#include <vector>

namespace stickslip {

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

}  // namespace stickslip
