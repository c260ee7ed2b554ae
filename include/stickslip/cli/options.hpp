#pragma once
/// Values of the table's options as the user gave them.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stickslip/model/effect.hpp"

namespace stickslip::cli {

// The one table of options: validation, help and pages are made from it.

using effects::Kind;
using effects::Option;
using effects::Range;

struct Group {
  std::string title;
  std::string explanation;
  std::vector<Option> options;
};

/// What is no option of the table: texts that end the run, and families of PETSc's own options.
struct OtherOption {
  std::string name;  ///< with its dash; with dots, a family
  std::string sentence;
  std::string synonyms = {};  ///< other names for it, a comma list
};

/// What a value must be, in a sentence: "a number in (0, inf)", "linear, none or cubic".
[[nodiscard]] std::string requirement(const Option& option);

/// The range or the words that its form leaves open; empty if there are none.
[[nodiscard]] std::string allowed(const Option& option);

/// The option of the model that an option sweeps; nullptr for any other option.
[[nodiscard]] const Option* swept_by(const Option& option);

/// All options by group, in the order of the help text.
[[nodiscard]] std::span<const Group> table();

/// The same without groups.
[[nodiscard]] std::span<const Option> all_options();

/// Options outside the table, in the order of the help text.
[[nodiscard]] std::span<const OtherOption> other_options();

/// The option of that name (without dash), or nullptr.
[[nodiscard]] const Option* find(std::string_view name);

/// Names with their dash, for suggestions.
[[nodiscard]] std::vector<std::string> all_names();

// Suggestions for words that are not known here: names that the literature and other programs use,
// PETSc's options without the prefix of a solver, and misspelt names.

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

/// "scene.opts:3" by the names of options (without dash) that count as files of -options_file state
/// them.
[[nodiscard]] std::map<std::string, std::string>& stated_places();

/// " (scene.opts:3)", for the end of a message about an option; empty if no file states it.
[[nodiscard]] std::string stated_in_file(const std::string& name);

/// Messages about everything that is wrong with the input, reported together.
class Problems {
 public:
  void add(std::string message) { messages_.push_back(std::move(message)); }
  /// "-delta = -1: must be ...; fix".
  void add(const Option& option, const std::string& value, const std::string& why,
           const std::string& fix);
  [[nodiscard]] bool empty() const { return messages_.empty(); }
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }
  /// Throws BadInput with all messages, if there are any.
  void raise() const;

 private:
  std::vector<std::string> messages_;
};

/// Typed access to the options of the table, with what is wrong with them. A number is not asked
/// for before its text is known to be one.
class Settings : public effects::Given {
 public:
  /// Reads all options of the table from the PETSc options database, and marks them used. Local.
  static Settings read();

  [[nodiscard]] bool has(const std::string& name) const override { return text_.contains(name); }
  /// The value as given or its default; empty if neither exists.
  [[nodiscard]] std::string text(const std::string& name) const override;
  [[nodiscard]] double real(const std::string& name) const override;
  /// The whole number given or the default; nothing if neither exists or a word was given.
  [[nodiscard]] std::optional<int> integer(const std::string& name) const override;
  [[nodiscard]] std::vector<std::string> list(const std::string& name) const;
  /// The numbers of a list option, empty if it was not given.
  [[nodiscard]] std::vector<double> numbers(const std::string& name) const;
  [[nodiscard]] bool flag(const std::string& name) const { return text(name) != "no"; }
  /// Gives the number option `name` another value, checked as if the user had given it.
  void set(const std::string& name, double value);
  void refuse(const std::string& name, const std::string& why, const std::string& fix) override;
  [[nodiscard]] bool sound() const override { return problems_.empty(); }
  [[nodiscard]] Problems& problems() { return problems_; }

 private:
  std::map<std::string, std::string> text_;
  Problems problems_;
};

}  // namespace stickslip::cli
