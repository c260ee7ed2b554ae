#include "quantities.hpp"

#include <algorithm>

#include "stickslip/support/text.hpp"

namespace stickslip::options {

std::vector<std::string> quantity_words() {
  std::vector<std::string> words;
  for (const auto* entry : catalogue::entries()) words.emplace_back(entry->word);
  return words;
}

std::vector<std::string> keys_of(const catalogue::Entry& entry) {
  std::vector<std::string> keys;
  for (const auto* row : entry.rows) keys.emplace_back(row->key);
  for (const auto& key : split(entry.others, ',')) keys.push_back(key);
  return keys;
}

bool depends_on(const Question& question, const std::string& option) {
  const auto entries = catalogue::entries();
  return std::any_of(entries.begin(), entries.end(), [&](const catalogue::Entry* entry) {
    const auto options = split(entry->options, ',');
    return question.wants(entry->quantity) &&
           std::count(options.begin(), options.end(), option) > 0;
  });
}

}  // namespace stickslip::options
