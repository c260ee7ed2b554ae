#include "stickslip/support/number_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include "stickslip/support/text.hpp"

namespace stickslip {
namespace {

// Decimal exponent of x when it is printed with so many digits after the first.
int exponent(double x, int digits) {
  const std::string text = fmt::format("{:.{}e}", x, digits);
  return std::stoi(text.substr(text.find('e') + 1));
}

// first:last:count[:log]; nothing if the parts make no sense.
std::optional<std::vector<double>> parse_range(const std::vector<std::string>& parts) {
  const bool log = parts.size() == 4 && parts[3] == "log";
  if (parts.size() != 3 && !log) return std::nullopt;
  const auto first = parse_number(parts[0]), last = parse_number(parts[1]),
             count = parse_number(parts[2]);
  constexpr double most = 1e6;
  if (!first || !last || !count || *count != std::floor(*count)) return std::nullopt;
  if (*count < 2 || *count > most || !(*first < *last) || (log && *first <= 0)) return std::nullopt;
  std::vector<double> values;
  for (int n = 0; n < *count; ++n) {
    const double t = n / (*count - 1);
    values.push_back(log ? *first * std::pow(*last / *first, t) : *first + t * (*last - *first));
  }
  values.back() = *last;
  return values;
}

}  // namespace

std::string number_text(double value, double error) {
  constexpr int all = 16;      // digits after the first that tell every double from its neighbours
  if (value == 0) return "0";  // without the sign of -0
  if (std::isnan(value)) return "nan";
  if (error == 0 || !std::isfinite(value)) return fmt::format("{}", value);
  const int leading = exponent(value, all);
  const int place = std::isfinite(error) ? exponent(error, 1) : leading;
  const int digits = std::clamp(leading - place, 0, all);
  if (digits == all) return fmt::format("{}", value);
  // As %g does: no zeros that nobody knows, and few before the first digit.
  const bool fixed = leading >= -4 && leading <= digits;
  return fixed ? fmt::format("{:.{}f}", value, digits - leading)
               : fmt::format("{:.{}e}", value, digits);
}

std::string error_text(double error) {
  if (!std::isfinite(error)) return "-";
  return error == 0 ? "0" : fmt::format("{:.1e}", error);
}

std::string seconds_text(double seconds) {
  const double decimals = seconds < 1 ? 3 : 3 - std::floor(std::log10(seconds));
  return fmt::format("{:.{}f}", seconds, static_cast<int>(std::clamp(decimals, 0.0, 3.0)));
}

std::optional<double> parse_number(const std::string& text) {
  double value = 0;
  const bool plus = text.starts_with('+') && !text.starts_with("+-");
  const char* begin = text.data() + (plus ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<std::vector<double>> parse_numbers(const std::string& text) {
  const auto range = split(text, ':');
  if (range.size() > 1) return parse_range(range);
  std::vector<double> values;
  for (const auto& word : split(text, ',')) {
    const auto value = parse_number(word);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  return values;
}

}  // namespace stickslip
