#include "stickslip/cli/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>

#include "stickslip/base/errors.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/case/entry.hpp"
#include "stickslip/cli/options.hpp"
#include "stickslip/model/effect.hpp"

namespace stickslip::cli {
namespace {

using cases::SolutionMethod;

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
  for (const auto* quantity : cases::entries()) {
    auto keys = split(quantity->others, ',');
    std::transform(quantity->rows.begin(), quantity->rows.end(), std::inserter(keys, keys.begin()),
                   [](const cases::Row* row) { return std::string(row->key); });
    rows.emplace_back(quantity->word, fmt::format("{}{}{}", quantity->title,
                                                  keys.empty() ? "" : ": ", fmt::join(keys, ", ")));
  }
  return rows;
}

Rows other_rows() {
  Rows rows;
  for (const auto& other : other_options()) rows.emplace_back(other.name, other.sentence);
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
  for (const auto& group : table()) {
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
  for (const auto& group : table()) text += group_help(group);
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
  text += fmt::format("  local names='{}'\n", fmt::join(all_names(), " "));
  text += "  COMPREPLY=()\n  case ${COMP_WORDS[COMP_CWORD - 1]} in\n";
  text += "    -options_file | -cases) _stickslip_files ;;\n";
  for (const auto& option : all_options()) {
    text += fmt::format("    -{}) {};;\n", option.name, completer(option));
  }
  return text + kCompletionEnd;
}

namespace {

using OrderedJson = nlohmann::ordered_json;

// What each word of a choice of effects means; {} for any other option.
OrderedJson meanings_of(const Option& option) {
  OrderedJson meanings = OrderedJson::object();
  for (const auto* choice : effects::choices()) {
    if (choice->option != option.name) continue;
    for (const auto* effect : choice->effects) {
      meanings[std::string(effect->word)] = effect->sentence;
    }
  }
  return meanings;
}

OrderedJson owners_of(const Option& option) {
  OrderedJson owners = OrderedJson::object();
  for (const auto* choice : effects::choices()) {
    for (const auto* effect : choice->effects) {
      if (effect->knows(option.name)) owners[std::string(choice->option)].push_back(effect->word);
    }
  }
  return owners;
}

// Whether words cannot do without the option.
bool is_needed(const Option& option) {
  for (const auto* choice : effects::choices()) {
    for (const auto* effect : choice->effects) {
      for (const auto& parameter : effect->parameters) {
        if (parameter.option.name == option.name && !parameter.example.empty()) return true;
      }
    }
  }
  return false;
}

OrderedJson json_of(const std::optional<effects::Slider>& slider) {
  if (!slider) return nullptr;
  return {{"low", slider->low},
          {"high", slider->high},
          {"start", slider->start ? OrderedJson(*slider->start) : OrderedJson()},
          {"logarithmic", slider->logarithmic}};
}

OrderedJson json_of(const Option& option, const Group& group) {
  const bool ranged =
      option.kind == Kind::real || option.kind == Kind::integer || option.kind == Kind::numbers;
  return {{"name", option.name},
          {"group", group.title},
          {"form", option.form},
          {"unit", option.unit},
          {"default", option.initial},
          {"range", ranged ? option.range.text() : ""},
          {"words", option.words},
          {"meanings", meanings_of(option)},
          {"sentence", option.sentence},
          {"symbol", option.shown.symbol},
          {"label", option.shown.label},
          {"slider", json_of(option.shown.slider)},
          {"belongs_to", owners_of(option)},
          {"needed", is_needed(option)}};
}

// The keys of its results, each with the option that it is an array over; "" for a scalar.
OrderedJson json_of(const cases::Entry& quantity) {
  OrderedJson keys = OrderedJson::object();
  for (const auto* row : quantity.rows) keys[std::string(row->key)] = row->abscissa;
  return {{"word", quantity.word}, {"keys", keys}};
}

}  // namespace

std::string reference_json() {
  OrderedJson options = OrderedJson::array();
  for (const auto& group : table()) {
    for (const auto& option : group.options) options.push_back(json_of(option, group));
  }
  OrderedJson quantities = OrderedJson::array();
  for (const auto* quantity : cases::entries()) quantities.push_back(json_of(*quantity));
  return OrderedJson{{"options", options}, {"quantities", quantities}}.dump(1) + "\n";
}

namespace {

constexpr std::size_t kWidth = 110;

// `text` with a backslash before each of the characters.
std::string escaped(std::string_view text, std::string_view characters) {
  std::string result;
  for (const char c : text) {
    if (characters.find(c) != characters.npos) result += '\\';
    result += c;
  }
  return result;
}

// A cell of a Markdown table: a bar would end it, and stars would set what is between them in
// italics.
std::string table_cell(std::string_view text) { return escaped(text, "|*"); }

std::string code(std::string_view text) { return fmt::format("`{}`", escaped(text, "|")); }

std::string row(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

// The first lines of a table.
std::string head(const std::vector<std::string>& titles) {
  return row(titles) + row(std::vector<std::string>(titles.size(), "---"));
}

std::string option_rows(const Group& group) {
  std::string text = head({"option", "form", "unit", "default", "allowed", "meaning"});
  for (const auto& o : group.options) {
    if (swept_by(o) != nullptr) continue;
    text += row({code("-" + o.name), o.form, table_cell(o.unit), table_cell(o.initial),
                 table_cell(allowed(o)), table_cell(o.sentence)});
  }
  return text;
}

// The options that sweep others, as one sentence; empty if the group has none.
std::string swept_options(const Group& group) {
  std::vector<std::string> names;
  for (const auto& option : group.options) {
    if (swept_by(option) != nullptr) names.push_back(code("-" + option.name));
  }
  if (names.empty()) return "";
  return wrap(fmt::format("{} have the form numbers: values of the option of the same name, in its "
                          "unit and range.",
                          enumerate(names, "and")),
              kWidth, 0) +
         "\n\n";
}

// A letter for a solution method.
char letter(const SolutionMethod& method) {
  return static_cast<char>(std::toupper(static_cast<unsigned char>(method.word[0])));
}

// The letters of the routes that give a result, those of `without` left out.
std::string letters(cases::Routes routes, cases::Routes without = {}) {
  std::string text;
  for (const auto& method : cases::solution_methods()) {
    if (!routes.contains(method.route) || without.contains(method.route)) continue;
    text += fmt::format("{}{}", text.empty() ? "" : " ", letter(method));
  }
  return text;
}

std::string routes_explained() {
  std::vector<std::string> names, without_drag;
  std::string limits;
  for (const auto& method : cases::solution_methods()) {
    names.push_back(fmt::format("{} {}", letter(method), code(method.word)));
    if (!method.without_drag.empty()) without_drag.push_back(code(method.word));
    if (method.limit.empty()) continue;  // gives all
    limits += fmt::format("- {}: {}.\n", code(method.word), wrap(method.limit, 100, 2));
  }
  return wrap(fmt::format("The column `-route` names the solution methods by letters: "
                          "{}. They hold with and without symmetry, for either `-scheme`; "
                          "{} needs a model without drag.",
                          enumerate(names, "and"), enumerate(without_drag, "and")),
              kWidth, 0) +
         "\n\n" + limits;
}

std::string quantity_rows() {
  std::string text = head({"quantity", "what it gives", "its options", "-route"});
  for (const auto* q : cases::entries()) {
    std::vector<std::string> options;
    for (const auto& option : q->all_options()) options.push_back(code("-" + option));
    text += row({code(q->word), table_cell(q->title), fmt::format("{}", fmt::join(options, ", ")),
                 letters(q->routes)});
  }
  return text;
}

std::string result_rows() {
  std::string text = head(
      {"key", "quantity", "symbol", "definition", "unit", "over", "convention", "paper", "-route"});
  for (const auto* q : cases::entries()) {
    for (const auto* r : q->rows) {
      text += row({code(r->key), code(q->word), code(r->symbol), table_cell(r->definition),
                   table_cell(r->unit), table_cell(r->abscissa), table_cell(r->convention),
                   r->paper.empty() ? "-" : table_cell(r->paper), letters(q->routes, r->without)});
    }
  }
  return text;
}

}  // namespace

std::string reference_page() {
  std::string text =
      "# Options\n\n"
      "Generated by `stickslip -reference` from the table that also validates the options. Options "
      "are\n"
      "given on the command line or in an options file (`-options_file scene.opts`, one `-name "
      "value` a\n"
      "line, `#` for comments); the last one given counts. [quantities.md](quantities.md) defines "
      "the\nquantities and the states s+ and s-.\n\n"
      "## Forms of values\n\n" +
      head({"form", "value"});
  for (const auto& [form, meaning] : forms()) text += row({form, table_cell(meaning)});
  for (const auto& group : table()) {
    text += fmt::format("\n## {}\n\n{}.\n\n{}{}", group.title, wrap(group.explanation, kWidth, 0),
                        swept_options(group), option_rows(group));
  }
  text += "\n## Other options\n\n" + head({"option", "meaning"});
  for (const auto& other : other_options())
    text += row({code(other.name), table_cell(other.sentence)});
  text += "\n## Exit status\n\n" + head({"status", "meaning"});
  for (const auto& [status, meaning] : kExitMeanings)
    text += row({std::to_string(status), meaning});
  return text;
}

std::string quantity_tables() {
  return "## Quantities\n\n" + quantity_rows() + "\n" + routes_explained() + "\n## Keys\n\n" +
         result_rows();
}

}  // namespace stickslip::cli
