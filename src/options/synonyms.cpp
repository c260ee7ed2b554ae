#include "stickslip/options/synonyms.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "stickslip/catalogue/entry.hpp"
#include "stickslip/effects/effect.hpp"
#include "stickslip/support/text.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

// How options of PETSc's objects begin, and the prefixes of the solvers that have such an object.
constexpr struct {
  const char *beginning, *solvers;
} kFamilies[] = {{"ksp_", "slide_"},       {"pc_", "slide_"},      {"sub_", "slide_"},
                 {"mat_mumps_", "slide_"}, {"mat_view", "slide_"}, {"eps_", "relax_, null_"},
                 {"st_", "relax_, null_"}};

const Synonyms* synonyms_of(const std::string& other, const std::string& option) {
  for (const auto& row : all_synonyms()) {
    const bool fits = option.empty() ? row.word.empty() : !row.word.empty() && row.option == option;
    if (fits && std::count(row.others.begin(), row.others.end(), other) > 0) return &row;
  }
  return nullptr;
}

// A name of PETSc with the prefixes that it lacks; empty if it is no such name.
std::string with_prefixes(const std::string& name) {
  for (const auto& [beginning, solvers] : kFamilies) {
    if (!name.starts_with(beginning)) continue;
    auto prefixes = split(solvers, ',');
    for (auto& prefix : prefixes) prefix = fmt::format("-{}{}", prefix, name);
    return enumerate(prefixes, "or");
  }
  return "";
}

// The option that a name means, with its dash; empty if there is none.
std::string meant_option(const std::string& name) {
  std::string solver = with_prefixes(name);
  if (!solver.empty()) return solver;
  const Synonyms* row = synonyms_of(name, "");
  return row != nullptr ? "-" + row->option : nearest_word("-" + name, all_names());
}

std::string suggested(const std::string& meant, const Synonyms* row) {
  const bool has_page = row != nullptr && !row->page.empty();
  return fmt::format("did you mean {}?{}", meant, has_page ? " See " + row->page : "");
}

// The same as meant_option for a name and a value that are joined by an equals sign at `sign`.
std::string apart(const std::string& name, std::size_t sign) {
  const std::string before = name.substr(0, sign), after = name.substr(sign + 1);
  const std::string meant = find(before) != nullptr ? "-" + before : meant_option(before);
  return fmt::format("write {} {}", meant.empty() ? "-name" : meant,
                     after.empty() ? "value" : after);
}

}  // namespace

std::span<const Synonyms> all_synonyms() {
  static const auto all = [] {
    std::vector<Synonyms> rows;
    const auto add = [&rows](std::string_view option, std::string_view word,
                             const std::vector<std::string>& others, const std::string& page = "") {
      if (!others.empty()) rows.push_back({std::string(option), std::string(word), others, page});
    };
    const auto add_words = [&add](std::string_view option, const auto& words) {
      for (const auto& each : words) add(option, each.word, split(each.synonyms, ','));
    };
    for (const auto& option : all_options()) {
      add(option.name, "", option.shown.others, option.shown.page);
    }
    for (const auto& other : other_options()) {
      add(other.name.substr(1), "", split(other.synonyms, ','));
    }
    for (const auto* choice : effects::choices()) {
      for (const auto* effect : choice->effects) {
        add(choice->option, effect->word, effect->others);
        add(choice->option, effect->word, effect->explained, effect->page);
      }
    }
    for (const auto* entry : catalogue::entries()) {
      add("quantities", entry->word, split(entry->synonyms, ','));
    }
    add_words("route", catalogue::solution_methods());
    add_words("scheme", kSchemes);
    return rows;
  }();
  return all;
}

std::string suggestion_for_option(const std::string& name) {
  if (const auto sign = name.find('='); sign != name.npos) return apart(name, sign);
  const std::string meant = meant_option(name);
  if (meant.empty()) return "-help lists all";
  return suggested(meant, synonyms_of(name, ""));
}

std::string suggestion_for_word(const Option& option, const std::string& word) {
  const std::string meant = meant_word(option, word);
  if (meant.empty()) return "";
  return suggested(meant, synonyms_of(word, option.name));
}

std::string meant_word(const Option& option, const std::string& word) {
  if (const Synonyms* row = synonyms_of(word, option.name)) return row->word;
  const auto* quantity = option.name == "quantities" ? catalogue::entry_of(word) : nullptr;
  if (quantity != nullptr) return std::string(quantity->word);
  return nearest_word(word, option.words);
}

}  // namespace stickslip::options
