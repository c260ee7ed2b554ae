#include "stickslip/base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <stdexcept>

namespace stickslip {
namespace {

// Letters missing, added, changed, or exchanged with their neighbour.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> rows(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  std::iota(rows[0].begin(), rows[0].end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    rows[i][0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = rows[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      rows[i][j] = std::min({changed, rows[i][j - 1] + 1, rows[i - 1][j] + 1});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) rows[i][j] = std::min(rows[i][j], rows[i - 2][j - 2] + 1);
    }
  }
  return rows.back().back();
}

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

std::string nearest_word(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t smallest = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const auto& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < smallest) {
      smallest = distance;
      best = candidate;
    }
  }
  return best;
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  if (text.empty()) return parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    std::string_view part = text.substr(begin, end - begin);
    const auto first = part.find_first_not_of(" \t");
    const auto last = part.find_last_not_of(" \t");
    parts.emplace_back(first == part.npos ? "" : part.substr(first, last - first + 1));
    begin = end + 1;
  }
  return parts;
}

std::optional<std::vector<std::string>> quoted_words(std::string_view line) {
  constexpr char none = '\0';
  std::vector<std::string> words;
  bool within = false;
  char quote = none;
  for (char c : line) {
    const bool opens = quote == none && (c == '"' || c == '\'');
    const bool separates = quote == none && (c == ' ' || c == '\t' || c == '\r');
    if (!separates && !within) words.emplace_back();
    within = !separates;
    if (opens) {
      quote = c;
    } else if (c == quote) {
      quote = none;
    } else if (!separates) {
      words.back() += c;
    }
  }
  if (quote != none) return std::nullopt;
  return words;
}

std::string enumerate(std::span<const std::string> words, std::string_view conjunction) {
  std::string text;
  for (std::size_t n = 0; n < words.size(); ++n) {
    if (n > 0) text += n + 1 == words.size() ? " " + std::string(conjunction) + " " : ", ";
    text += words[n];
  }
  return text;
}

std::string wrap(std::string_view text, std::size_t width, std::size_t indent) {
  std::string result;
  std::size_t column = 0;
  for (const auto& word : split(text, ' ')) {
    if (column > 0 && column + 1 + word.size() > width) {
      result += "\n" + std::string(indent, ' ');
      column = 0;
    } else if (column > 0) {
      result += ' ';
      ++column;
    }
    result += word;
    column += word.size();
  }
  return result;
}

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

void require_readable(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error) && std::ifstream(file).good()) return;
  throw std::invalid_argument("cannot be read");
}

}  // namespace stickslip
