#include "quantities.hpp"

#include <algorithm>

#include "stickslip/support/text.hpp"

namespace stickslip::options {

std::vector<std::string> quantity_words() {
  std::vector<std::string> words;
  for (const auto* entry : catalogue::entries()) words.emplace_back(entry->word);
  return words;
}

const char* limit_of(Route route) {
  switch (route) {
  case Route::excursion: return "";
  case Route::lambda:
    return "lambda u_lambda tends to stationary averages as lambda -> 0, and gives nothing else";
  case Route::hitting: return "mean hitting times give mean durations, and nothing else";
  case Route::null_vector:
    return "the left null vector of the generator is the stationary distribution, and gives its "
           "averages alone";
  case Route::fluid_queue:
    return "the fluid queue gives the hitting distribution, durations and the moments of V up to "
           "the second";
  case Route::monte_carlo:
    return "a sample has no eigenvalues, no derivatives, and no density at a point (take averages "
           "of indicator functions such as abs(v)>0.5)";
  }
  return "";
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
