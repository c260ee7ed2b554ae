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
using OrderedJson = nlohmann::ordered_json;

/// What pages list: a name, the form of what stands behind it, if any, and what it is.
struct Item {
  std::string name, form, meaning;
};

/// Items under a title.
struct Part {
  std::string title, explanation;
  std::vector<Item> items;
};

// A list of names and their meanings.
template <class List>
std::vector<Item> items_of(const List& rows) {
  std::vector<Item> items;
  for (const auto& [name, meaning] : rows) {
    items.push_back({fmt::format("{}", name), "", fmt::format("{}.", meaning)});
  }
  return items;
}

// Each as `write` has it, one after the other.
template <class Write>
std::string joined(const std::vector<Item>& items, const Write& write) {
  std::string text;
  for (const auto& item : items) text += write(item);
  return text;
}

// Quantities with their titles and the keys that they write, those of other quantities that come
// with them included.
std::vector<Item> quantities_with_keys() {
  std::vector<Item> items;
  for (const auto* quantity : cases::entries()) {
    auto keys = split(quantity->others, ',');
    std::transform(quantity->rows.begin(), quantity->rows.end(), std::inserter(keys, keys.begin()),
                   [](const cases::Row* row) { return std::string(row->key); });
    items.push_back(
        {std::string(quantity->word), "",
         fmt::format("{}{}{}.", quantity->title, keys.empty() ? "" : ": ", fmt::join(keys, ", "))});
  }
  return items;
}

bool has_range(const Option& option) {
  return option.kind == Kind::real || option.kind == Kind::integer || option.kind == Kind::numbers;
}

// What it does, with its unit, the range or the words allowed, and its default; of a file the
// sentence speaks.
std::string description(const Option& option) {
  const std::string words = enumerate(option.words, "or");
  const bool file = option.kind == Kind::path || option.kind == Kind::input;
  const bool of_words = option.kind == Kind::choice || option.kind == Kind::flag;
  std::string text = option.sentence;
  if (!option.unit.empty()) text += fmt::format(" [{}]", option.unit);
  if (has_range(option)) {
    text += fmt::format("; {} in {}{}{}", option.form, option.range.text(),
                        words.empty() ? "" : " or ", words);
  } else if (!file) {
    text += "; " + (of_words ? words : "form " + option.form);
  }
  if (!option.initial.empty()) text += "; default " + option.initial;
  return text + ".";
}

// The options that sweep others.
std::vector<std::string> swept_names(const Group& group) {
  std::vector<std::string> names;
  for (const auto& option : group.options) {
    if (swept_by(option) != nullptr) names.push_back("-" + option.name);
  }
  return names;
}

// All options by group, and what stands outside the table. Those that sweep others are one item.
std::vector<Part> option_parts() {
  std::vector<Part> parts;
  for (const auto& group : table()) {
    auto& part = parts.emplace_back(Part{group.title, group.explanation + ".", {}});
    const auto swept = swept_names(group);
    if (!swept.empty()) {
      part.items.push_back({fmt::format("{}", fmt::join(swept, ", ")), "numbers",
                            "values of the option of the same name; numbers in its unit and "
                            "range."});
    }
    for (const auto& option : group.options) {
      if (swept_by(option) != nullptr) continue;
      part.items.push_back({"-" + option.name, option.form, description(option)});
    }
  }
  auto& other = parts.emplace_back(Part{"Other", "", {}});
  for (const auto& row : other_options()) other.items.push_back({row.name, "", row.sentence + "."});
  return parts;
}

// An entry of a list in roff, its name in the font B or I.
std::string roff_item(char font, const Item& item) {
  const std::string form = item.form.empty() ? "" : fmt::format(" \\fI{}\\fR", item.form);
  return fmt::format(".TP\n\\f{}{}\\fR{}\n{}\n", font, roff(item.name), form, roff(item.meaning));
}
std::string bold_item(const Item& item) { return roff_item('B', item); }
std::string italic_item(const Item& item) { return roff_item('I', item); }

std::string roff_part(const Part& part) {
  const std::string explained = part.explanation.empty() ? "" : roff(part.explanation) + "\n";
  return fmt::format(".SS {}\n{}{}", roff(part.title), explained, joined(part.items, bold_item));
}

constexpr const char* kManualHead = R"(.SH NAME
stickslip, stickslip\-complex \- dry friction under random forcing
.SH SYNOPSIS
.B stickslip
.RI [\fB\-options_file\fR " file" ]
.RI [\fB\-\fIname " value" " ...]"
.br
.B mpiexec \-n
.I ranks
.B stickslip
.RI [\fB\-\fIname " value" " ...]"
.SH DESCRIPTION
.PP
A body of unit mass slides on a rough floor, pushed by a random force X with a finite
correlation time. The program computes the stationary distribution of the force and the
velocity, spectra, durations and more of this piecewise deterministic Markov process, each
number with an estimate of its error. A table goes to standard output.
.PP
Every choice is a PETSc option, on the command line or in an options file; the last one given
counts. stickslip\-complex is the same program with complex scalars.
)";

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

constexpr std::pair<const char*, const char*> kFiles[] = {
    {"PREFIX/share/stickslip/options", "Options files to start from"},
    {"PREFIX/share/doc/stickslip", "Tutorial, method, format of the output, and other pages"},
    {"PREFIX/lib/python3/dist-packages/stickslip",
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
std::string help_item(const Item& item, std::size_t margin) {
  constexpr std::size_t column = 21, width = 76;
  const std::size_t name = margin + item.name.size();
  return fmt::format("{:{}}{}{}{:{}}{}\n", "", margin, wrap(item.name, 94, 2),
                     name < column ? "" : "\n", "", name < column ? column - name : column,
                     wrap(item.meaning, width, column));
}

std::string option_item(const Item& item) {
  const auto inner = [](const Item& quantity) { return help_item(quantity, 4); };
  const bool list = item.name == "-quantities";
  return help_item(item, 2) + (list ? joined(quantities_with_keys(), inner) : "");
}

std::string help_part(const Part& part) {
  const std::string title = part.explanation.empty()
                                ? part.title + ":"
                                : part.title + ". " + wrap(part.explanation, 88, 2);
  return "\n" + title + "\n" + joined(part.items, option_item);
}

OrderedJson json_of(const std::optional<effects::Slider>& slider) {
  if (!slider) return nullptr;
  return {{"low", slider->low},
          {"high", slider->high},
          {"start", slider->start ? OrderedJson(*slider->start) : OrderedJson()},
          {"logarithmic", slider->logarithmic}};
}

OrderedJson json_of(const Option& option, const Group& group) {
  OrderedJson meanings = OrderedJson::object(), owners = OrderedJson::object();
  bool needed = false;  // whether words of a choice cannot do without the option
  for (const auto* choice : effects::choices()) {
    for (const auto* effect : choice->effects) {
      if (choice->option == option.name) meanings[std::string(effect->word)] = effect->sentence;
      if (effect->knows(option.name)) owners[std::string(choice->option)].push_back(effect->word);
      needed |= std::ranges::any_of(effect->parameters, [&](const auto& parameter) {
        return parameter.option.name == option.name && !parameter.example.empty();
      });
    }
  }
  return {{"name", option.name},         {"group", group.title},
          {"form", option.form},         {"unit", option.unit},
          {"default", option.initial},   {"range", has_range(option) ? option.range.text() : ""},
          {"words", option.words},       {"meanings", meanings},
          {"sentence", option.sentence}, {"symbol", option.shown.symbol},
          {"label", option.shown.label}, {"slider", json_of(option.shown.slider)},
          {"belongs_to", owners},        {"needed", needed}};
}

// The keys of its results, each with the option that it is an array over; "" for a scalar.
OrderedJson json_of(const cases::Entry& quantity) {
  OrderedJson keys = OrderedJson::object();
  for (const auto* row : quantity.rows) keys[std::string(row->key)] = row->abscissa;
  return {{"word", quantity.word}, {"keys", keys}};
}

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
  auto names = swept_names(group);
  if (names.empty()) return "";
  std::ranges::transform(names, names.begin(), [](const auto& name) { return code(name); });
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
      {"terms",
       "numbers separated by commas, in groups separated by semicolons, such as \"0.8,0.5; "
       "0.2,3,10\""},
      {"state", "s+ or s-, where a sliding phase starts; x,v with x a noise level; rest, V = 0 and "
                "X in its stationary distribution; stationary, the stationary distribution; on a "
                "spring x,v,p or rest,p at a position p, or stationary"}};
  return all;
}

std::string help_text() {
  std::string text =
      "stickslip: dry friction under random forcing, to the digits you ask for\n\n"
      "  stickslip -options_file scene.opts [-name value ...]\n\n"
      "Every choice is a PETSc option, on the line or in an options file; the last one given "
      "counts.\n" +
      help_part({"Forms of values", "", items_of(forms())});
  for (const auto& part : option_parts()) text += help_part(part);
  std::string status = "Exit status: ";
  for (const auto& [number, meaning] : kExitMeanings) {
    status += fmt::format("{}{} {}", number == kExitMeanings[0].first ? "" : "; ", number, meaning);
  }
  return text + "\n" + wrap(status, 88, 0) + ".\n";
}

std::string roff(std::string_view text) {
  static const std::map<char, std::string> escapes{{'\\', "\\e"},  {'-', "\\-"},   {'^', "\\(ha"},
                                                   {'~', "\\(ti"}, {'`', "\\(ga"}, {'\'', "\\(aq"}};
  const bool command = !text.empty() && (text.front() == '.' || text.front() == '\'');
  std::string line = command ? "\\&" : "";
  for (const char c : text) {
    const auto found = escapes.find(c);
    line += found == escapes.end() ? std::string(1, c) : found->second;
  }
  return line;
}

std::string man_page(std::string_view version) {
  std::string text =
      fmt::format(".\\\" Generated by `stickslip \\-man_page` from the table of options.\n"
                  ".TH STICKSLIP 1 \"\" \"stickslip {}\" \"User Commands\"\n.nh\n.ad l\n{}"
                  ".SH VALUES\n{}.SH OPTIONS\n",
                  roff(version), kManualHead, joined(items_of(forms()), italic_item));
  for (const auto& part : option_parts()) text += roff_part(part);
  return text + fmt::format(".SH QUANTITIES\n{}.SH EXIT STATUS\n{}.SH EXAMPLES\n{}.SH FILES\n{}"
                            ".SH SEE ALSO\n\\fBmpiexec\\fR(1)\n",
                            joined(quantities_with_keys(), bold_item),
                            joined(items_of(kExitMeanings), bold_item),
                            joined(items_of(kExamples), bold_item),
                            joined(items_of(kFiles), italic_item));
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

std::string reference_json() {
  OrderedJson options = OrderedJson::array();
  for (const auto& group : table()) {
    for (const auto& option : group.options) options.push_back(json_of(option, group));
  }
  OrderedJson quantities = OrderedJson::array();
  for (const auto* quantity : cases::entries()) quantities.push_back(json_of(*quantity));
  return OrderedJson{{"options", options}, {"quantities", quantities}}.dump(1) + "\n";
}

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
