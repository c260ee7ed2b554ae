#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "stickslip/catalogue/entry.hpp"
#include "stickslip/options/table.hpp"
#include "stickslip/pages/pages.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::pages {
namespace {

using options::Group;
using options::Kind;
using options::Option;
using options::swept_by;

std::string escaped(char c) {
  static const std::map<char, std::string> escapes{{'\\', "\\e"},  {'-', "\\-"},   {'^', "\\(ha"},
                                                   {'~', "\\(ti"}, {'`', "\\(ga"}, {'\'', "\\(aq"}};
  const auto found = escapes.find(c);
  return found == escapes.end() ? std::string(1, c) : found->second;
}

std::string paragraph(std::string_view text) { return fmt::format(".PP\n{}\n", roff(text)); }

std::string section(std::string_view title, const std::string& body) {
  return fmt::format(".SH {}\n{}", title, body);
}

// An entry of a list; `head` is roff already.
std::string entry(const std::string& head, const std::string& body) {
  return fmt::format(".TP\n{}\n{}\n", head, roff(body));
}

std::string bold(std::string_view text) { return fmt::format("\\fB{}\\fR", roff(text)); }

std::string bold_entry(const std::string& name, const std::string& meaning) {
  return entry(bold(name), meaning);
}

std::string italic_entry(const std::string& name, const std::string& meaning) {
  return entry(fmt::format("\\fI{}\\fR", name), meaning);
}

// A list of names and their meanings, each as `write` has it.
template <class List>
std::string entries(const List& rows,
                    std::string (*write)(const std::string& name, const std::string& meaning)) {
  std::string text;
  for (const auto& [name, meaning] : rows) {
    text += write(fmt::format("{}", name), fmt::format("{}.", meaning));
  }
  return text;
}

using Rows = std::vector<std::pair<std::string, std::string>>;

// Quantities with their titles and the keys that they write, those of other quantities that come
// with them included.
Rows quantities_with_keys() {
  Rows rows;
  for (const auto* quantity : catalogue::entries()) {
    auto keys = split(quantity->others, ',');
    std::transform(quantity->rows.begin(), quantity->rows.end(), std::inserter(keys, keys.begin()),
                   [](const catalogue::Row* row) { return std::string(row->key); });
    rows.emplace_back(quantity->word, fmt::format("{}{}{}", quantity->title,
                                                  keys.empty() ? "" : ": ", fmt::join(keys, ", ")));
  }
  return rows;
}

Rows other_rows() {
  Rows rows;
  for (const auto& other : options::other_options()) rows.emplace_back(other.name, other.sentence);
  return rows;
}

// The form, with the range or the words allowed; nothing for a file, of which the sentence speaks.
std::string short_requirement(const Option& option) {
  std::string words = enumerate(option.words, "or");
  switch (option.kind) {
  case Kind::real:
  case Kind::integer:
  case Kind::numbers:
    return fmt::format("{} in {}{}{}", option.form, option.range.text(),
                       words.empty() ? "" : " or ", words);
  case Kind::choice:
  case Kind::flag: return words;
  case Kind::path:
  case Kind::input: return "";
  default: return "form " + option.form;
  }
}

// What it does, with its unit, default and range.
std::string description(const Option& option) {
  std::string text = option.sentence;
  if (!option.unit.empty()) text += fmt::format(" [{}]", option.unit);
  const std::string must = short_requirement(option);
  if (!must.empty()) text += "; " + must;
  if (!option.initial.empty()) text += "; default " + option.initial;
  return text + ".";
}

// "-sweep_mu_s, -sweep_mu_d, ..." of a group; empty if it has none.
std::string swept_names(const Group& group) {
  std::vector<std::string> names;
  for (const auto& option : group.options) {
    if (swept_by(option) != nullptr) names.push_back("-" + option.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

constexpr const char* kSweptHelp =
    "values of the option of the same name; numbers in its unit and range.";

std::string option_items() {
  std::string text;
  for (const auto& group : options::table()) {
    text += fmt::format(".SS {}\n{}\n", roff(group.title), roff(group.explanation + "."));
    const std::string swept = swept_names(group);
    if (!swept.empty()) text += entry(bold(swept) + " \\fInumbers\\fR", kSweptHelp);
    for (const auto& option : group.options) {
      if (swept_by(option) != nullptr) continue;
      text += entry(fmt::format("{} \\fI{}\\fR", bold("-" + option.name), option.form),
                    description(option));
    }
  }
  return text + ".SS Other\n" + entries(other_rows(), bold_entry);
}

constexpr const char* kSynopsis = R"(.B stickslip
.RI [\fB\-options_file\fR " file" ]
.RI [\fB\-\fIname " value" " ...]"
.br
.B mpiexec \-n
.I ranks
.B stickslip
.RI [\fB\-\fIname " value" " ...]"
)";

std::string introduction() {
  return paragraph("A body of unit mass slides on a rough floor, pushed by a random force X with a "
                   "finite correlation time. The program computes the stationary distribution of "
                   "the force and the velocity, spectra, durations and more of this piecewise "
                   "deterministic Markov process, each number with an estimate of its error. A "
                   "table goes to standard output.") +
         paragraph(
             "Every choice is a PETSc option, on the command line or in an options file; the last "
             "one given counts. stickslip-complex is the same program with complex scalars.");
}

// Command lines and what they do.
constexpr std::pair<const char*, const char*> kExamples[] = {
    {"stickslip -mu_d 0.25 -accuracy 1e-8", "Sticking and moments to eight digits"},
    {"stickslip -mu_d 0.5 -quantities density -output distribution.h5",
     "The stationary distribution as a field, in HDF5"},
    {"stickslip -mu_d 0.25 -quantities spectrum -omega 0.01:50:200:log -summary spectrum.json",
     "The power spectral density of the velocity, as JSON"},
    {"stickslip -options_file scene.opts -plan",
     "What a file of options would compute, and what that would cost"},
    {"mpiexec -n 4 stickslip -sweep_mu_d 0.1:1:10 -checkpoint sweep.record -sweep_csv sweep.csv",
     "Ten coefficients of friction on four ranks; run again, it resumes"},
};

// Names in roff.
constexpr std::pair<const char*, const char*> kFiles[] = {
    {"PREFIX/share/stickslip/options", "Options files to start from"},
    {"PREFIX/share/doc/stickslip", "Tutorial, method, format of the output, and other pages"},
    {"PREFIX/lib/python3/dist\\-packages/stickslip",
     "Python package that runs the program and draws what was computed"}};

constexpr const char* kCompletionHead =
    R"(# shellcheck shell=bash
# Completion of the command line of stickslip for bash.
# Generated by `stickslip -completion` from the table of options.

_stickslip_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }

_stickslip_files() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -f -- "$word")
}

# The words of a comma list that are not in it yet.
_stickslip_list() {
  local taken=${word%"${word##*,}"} left='' candidate
  for candidate in $1; do
    [[ ,$taken == *,$candidate,* ]] || left+=" $candidate"
  done
  compopt -o nospace 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -P "$taken" -W "$left" -- "${word#"$taken"}")
}

_stickslip() {
  local word=${COMP_WORDS[COMP_CWORD]}
)";

constexpr const char* kCompletionEnd = R"(    *) _stickslip_words "$names" ;;
  esac
}
complete -F _stickslip stickslip stickslip-complex
)";

// What completes the value of an option; numbers and texts have nothing to offer.
std::string completer(const Option& option) {
  const std::string words = fmt::format("{}", fmt::join(option.words, " "));
  switch (option.kind) {
  case Kind::path:
  case Kind::input: return "_stickslip_files ";
  case Kind::list: return fmt::format("_stickslip_list '{}' ", words);
  case Kind::flag: return fmt::format("_stickslip_words \"{} $names\" ", words);
  default: return words.empty() ? "" : fmt::format("_stickslip_words '{}' ", words);
  }
}

// A name and, in a column of its own, what it is; below the name if that is too long.
std::string help_entry(const std::string& name, const std::string& meaning) {
  constexpr std::size_t column = 21, width = 76;
  const bool beside = name.size() + 3 <= column;
  const std::string gap =
      beside ? std::string(column - 2 - name.size(), ' ') : "\n" + std::string(column, ' ');
  return fmt::format("  {}{}{}\n", name, gap, wrap(meaning, width, column));
}

std::string group_help(const Group& group) {
  std::string text = fmt::format("\n{}. {}.\n", group.title, wrap(group.explanation, 88, 2));
  const std::string swept = swept_names(group);
  if (!swept.empty()) text += help_entry(wrap(swept, 94, 2), kSweptHelp);
  for (const auto& option : group.options) {
    if (swept_by(option) != nullptr) continue;
    text += help_entry("-" + option.name, description(option));
    if (option.name == "quantities") {
      text +=
          entries(quantities_with_keys(), [](const std::string& word, const std::string& meaning) {
            return help_entry("  " + word, meaning);
          });
    }
  }
  return text;
}

std::string other_help() {
  std::string meanings;
  for (const auto& [status, meaning] : kExitMeanings) {
    meanings += fmt::format("{}{} {}", meanings.empty() ? "" : "; ", status, meaning);
  }
  return fmt::format("\nOther:\n{}\n{}.\n", entries(other_rows(), help_entry),
                     wrap("Exit status: " + meanings, 88, 0));
}

}  // namespace

std::span<const std::pair<const char*, const char*>> forms() {
  static constexpr std::pair<const char*, const char*> all[] = {
      {"number", "a decimal number such as 0.25 or 1e-3"},
      {"integer", "a whole number"},
      {"word", "one of the words allowed"},
      {"list", "words separated by commas, without blanks, each at most once"},
      {"numbers",
       "a list a,b,c, or first:last:count for count >= 2 evenly spaced numbers from first to last, "
       "both included, or first:last:count:log for numbers evenly spaced in the logarithm"},
      {"flag", "yes or no; the option alone means yes"},
      {"file", "the name of a file"},
      {"formula", "a formula in v, mu_s, mu_d and tau; a value that begins with a minus sign needs "
                  "a blank before it in an options file"},
      {"functions",
       "functions of the state, separated by semicolons: 1, x, v, v^2, |v|, stick, slide, "
       "|x|<=mu_s, or formulas in x, y, v, mu_s and mu_d such as \"x*v; abs(v) > 0.5\", with y = "
       "sign(v), 0 at rest"},
      {"state", "s+ or s-, where a sliding phase starts; x,v with x a noise level; rest, V = 0 and "
                "X in its stationary distribution; stationary, the stationary distribution"}};
  return all;
}

std::string help_text() {
  std::string text =
      "stickslip: dry friction under random forcing, to the digits you ask for\n\n"
      "  stickslip -options_file scene.opts [-name value ...]\n\n"
      "Every choice is a PETSc option, on the line or in an options file; the last one given "
      "counts.\n"
      "\nForms of values:\n" +
      entries(forms(), help_entry);
  for (const auto& group : options::table()) text += group_help(group);
  return text + other_help();
}

std::string roff(std::string_view text) {
  const bool command = !text.empty() && (text.front() == '.' || text.front() == '\'');
  std::string line = command ? "\\&" : "";
  for (const char c : text) line += escaped(c);
  return line;
}

std::string man_page(std::string_view version) {
  return fmt::format(".\\\" Generated by `stickslip \\-man_page` from the table of options.\n"
                     ".TH STICKSLIP 1 \"\" \"stickslip {}\" \"User Commands\"\n.nh\n.ad l\n",
                     roff(version)) +
         section("NAME", roff("stickslip, stickslip-complex") + " \\- " +
                             roff("dry friction under random forcing") + "\n") +
         section("SYNOPSIS", kSynopsis) + section("DESCRIPTION", introduction()) +
         section("VALUES", entries(forms(), italic_entry)) + section("OPTIONS", option_items()) +
         section("QUANTITIES", entries(quantities_with_keys(), bold_entry)) +
         section("EXIT STATUS", entries(kExitMeanings, bold_entry)) +
         section("EXAMPLES", entries(kExamples, bold_entry)) +
         section("FILES", entries(kFiles, italic_entry)) +
         section("SEE ALSO", "\\fBmpiexec\\fR(1)\n");
}

std::string completion() {
  std::string text = kCompletionHead;
  text += fmt::format("  local names='{}'\n", fmt::join(options::all_names(), " "));
  text += "  COMPREPLY=()\n  case ${COMP_WORDS[COMP_CWORD - 1]} in\n";
  text += "    -options_file | -cases) _stickslip_files ;;\n";
  for (const auto& option : options::all_options()) {
    text += fmt::format("    -{}) {};;\n", option.name, completer(option));
  }
  return text + kCompletionEnd;
}

}  // namespace stickslip::pages
