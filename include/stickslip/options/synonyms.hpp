#pragma once
/// Suggestions for words that are not known here: names that the literature and other programs use,
/// PETSc's options without the prefix of a solver, and misspelt names.

#include <span>
#include <string>
#include <vector>

#include "stickslip/options/table.hpp"

namespace stickslip::options {

/// Other names for an option, or for a word of an option.
struct Synonyms {
  std::string option;               ///< without the dash
  std::string word;                 ///< empty: the names are those of the option itself
  std::vector<std::string> others;  ///< none of them an option or a word of the option
  std::string page;                 ///< of the manual where to read more; may be empty
};

/// All of them. Names that differ from the right one by a letter or two are found without.
[[nodiscard]] std::span<const Synonyms> all_synonyms();

/// What to do about the name of an option (without its dash) that nothing knows: "did you mean
/// -tau?", or where all options are listed.
[[nodiscard]] std::string suggestion_for_option(const std::string& name);

/// The word that may be meant by one that the option does not have; empty if there is none. A key
/// of a result means the quantity that it belongs to.
[[nodiscard]] std::string meant_word(const Option& option, const std::string& word);

/// "did you mean ou?", of a word that the option does not have; empty if none is near.
[[nodiscard]] std::string suggestion_for_word(const Option& option, const std::string& word);

}  // namespace stickslip::options
