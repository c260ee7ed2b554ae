#include "stickslip/support/text.hpp"

#include <algorithm>
#include <numeric>

namespace stickslip {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
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

}  // namespace stickslip
