#include "stickslip/options/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "stickslip/options/synonyms.hpp"
#include "stickslip/petsc/solver_options.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/number_text.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::options {
namespace {

void check_words(const Option& option, const std::string& value, Problems& problems) {
  const auto given = option.kind == Kind::list ? split(value, ',')
                     : option.adds             ? split(value, '+')
                                               : std::vector{value};
  const std::string must = "must be " + requirement(option);
  if (given.empty()) problems.add(option, value, must, "");
  for (auto word = given.begin(); word != given.end(); ++word) {
    if (std::count(option.words.begin(), option.words.end(), *word) == 0) {
      const std::string near = meant_word(option, *word);
      problems.add(option, *word, must, near.empty() ? "" : "did you mean " + near + "?");
    }
    if (std::find(given.begin(), word, *word) != word) {
      problems.add(option, value, "names " + *word + " twice", "name it once");
    }
  }
}

// What to write in the place of a number with a unit, a per cent sign or a decimal comma; else the
// fix given.
std::string written_plainly(const std::string& value, bool is_list, const std::string& fix) {
  char* behind = nullptr;
  const double number = std::strtod(value.c_str(), &behind);
  if (behind == value.c_str()) return fix;
  if (*behind == '%') return fmt::format("write {:g} for {:g} %", number / 100, number);
  if (*behind == ',' && !is_list) return "write the number with a decimal point";
  if (std::isalpha(static_cast<unsigned char>(*behind)) == 0) return fix;
  return "write the number alone: units are yours, such as m/s^2 for all forces and s for all "
         "times";
}

void check_numbers(const Option& option, const std::string& value, Problems& problems) {
  const std::string must = "must be " + requirement(option);
  const auto numbers = parse_numbers(value);
  if (!numbers) {
    const char* example = "write for example 0.1,1 or 0.01:10:31:log";
    return problems.add(option, value, must, written_plainly(value, true, example));
  }
  const auto bad = std::find_if(numbers->begin(), numbers->end(),
                                [&option](double v) { return !option.range.contains(v); });
  if (bad != numbers->end()) problems.add(option, fmt::format("{:g}", *bad), must, option.fix);
}

void check_number(const Option& option, const std::string& value, Problems& problems) {
  const bool is_word = std::count(option.words.begin(), option.words.end(), value) > 0;
  const auto number = parse_number(value);
  const bool fits = number && option.range.contains(*number) &&
                    (option.kind == Kind::real || *number == std::floor(*number));
  if (is_word || fits) return;
  problems.add(option, value, "must be " + requirement(option),
               number ? option.fix : written_plainly(value, false, option.fix));
}

void check_value(const Option& option, const std::string& value, Problems& problems) {
  if (value == "=") {
    return problems.add(option, value, "is no value",
                        "write -" + option.name + " value, without =");
  }
  const bool is_list = option.kind == Kind::list || option.kind == Kind::numbers;
  if (is_list && value.ends_with(',')) {
    return problems.add(option, value, "ends with a comma", "lists have no spaces, as in a,b");
  }
  switch (option.kind) {
  case Kind::real:
  case Kind::integer: return check_number(option, value, problems);
  case Kind::choice:
  case Kind::list: return check_words(option, value, problems);
  case Kind::numbers: return check_numbers(option, value, problems);
  case Kind::text: return;
  case Kind::flag:
    if (!value.empty()) check_words(option, value, problems);
    return;
  case Kind::path:
  case Kind::input:
    if (!value.empty()) return;
    problems.add(option, value, "must be " + requirement(option), "name the file after the option");
  }
}

}  // namespace

void Problems::add(const Option& option, const std::string& value, const std::string& why,
                   const std::string& fix) {
  std::string message = fmt::format("-{} = {}: {}", option.name, value, why);
  if (!fix.empty()) message += "; " + fix;
  add(message);
}

void Problems::raise() const {
  if (messages_.empty()) return;
  throw BadInput(fmt::format("{}", fmt::join(messages_, "\n")));
}

Settings Settings::read() {
  Settings settings;
  for (const auto& option : all_options()) {
    const auto given = petsc::option_value(option.name);
    if (!given) continue;
    std::string& value = settings.text_[option.name];
    value = given->substr(std::min(given->find_first_not_of(' '), given->size()));
    check_value(option, value, settings.problems_);
  }
  return settings;
}

std::string Settings::text(const std::string& name) const {
  const auto found = text_.find(name);
  return found != text_.end() ? found->second : find(name)->initial;
}

double Settings::real(const std::string& name) const { return parse_number(text(name)).value(); }

std::optional<int> Settings::integer(const std::string& name) const {
  const auto number = parse_number(text(name));
  return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

std::vector<std::string> Settings::list(const std::string& name) const {
  return split(text(name), ',');
}

std::vector<double> Settings::numbers(const std::string& name) const {
  return parse_numbers(text(name)).value_or(std::vector<double>{});
}

void Settings::set(const std::string& name, double value) {
  text_[name] = fmt::format("{}", value);  // reads back to the same bits
  check_value(*find(name), text_[name], problems_);
}

void Settings::refuse(const std::string& name, const std::string& why, const std::string& fix) {
  problems_.add(*find(name), text(name), why, fix);
}

}  // namespace stickslip::options
