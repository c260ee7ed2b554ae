#include "stickslip/cli/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "reading.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/case/entry.hpp"
#include "stickslip/cli/output.hpp"
#include "stickslip/linalg/solver_options.hpp"

namespace stickslip::cli {
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

constexpr std::string_view kSweeps = "sweep_";

using Words = std::vector<std::string>;

Option choice(const char* name, std::string_view initial, const Words& words,
              const std::string& sentence) {
  return {name, Kind::choice, "word", "", std::string(initial), {}, words, sentence, ""};
}

Option list(const char* name, const char* initial, const Words& words, const char* sentence) {
  return {name, Kind::list, "list", "", initial, {}, words, sentence, ""};
}

Option flag(const char* name, const char* sentence) {
  return {name, Kind::flag, "flag", "", "no", {}, {"yes", "no"}, sentence, ""};
}

Option numbers(const std::string& name, const std::string& unit, Range range,
               const std::string& sentence, const std::string& fix) {
  return {name, Kind::numbers, "numbers", unit, "", range, {}, sentence, fix};
}

// A list of numbers that quantities take.
Option argument_option(const cases::Argument& argument) {
  std::string sentence =
      fmt::format("{} of {}", argument.sentence, cases::takers_of(argument.option));
  if (!argument.besides.empty()) sentence += fmt::format(". {}", argument.besides);
  return numbers(std::string(argument.option), std::string(argument.unit),
                 {argument.low, argument.high, argument.low_included, false}, sentence,
                 fmt::format("take for example {}", argument.example))
      .called(split(argument.synonyms, ','));
}

// Of quantities that have an accuracy of their own where -accuracy is not given.
std::string usual_accuracies() {
  std::string text;
  for (const auto* entry : cases::entries()) {
    if (entry->usual_accuracy == 0) continue;
    text += fmt::format("{} {:g} with {}", text.empty() ? ". Unless given, it is" : ",",
                        entry->usual_accuracy, entry->word);
  }
  return text;
}

std::vector<Option> quantity_options() {
  Words words;
  for (const auto* entry : cases::entries()) words.emplace_back(entry->word);
  std::vector<Option> options{
      list("quantities", "sticking,moments,noise_law", words, "quantities to compute")
          .called({"q", "compute", "observables"}),
  };
  for (const auto* argument : cases::arguments()) options.push_back(argument_option(*argument));
  const std::vector<Option> others{
      Option::text_of("start", "state", "s+", "state at time 0 of " + cases::takers_of("start"))
          .called({"x0", "v0", "initial", "initial_state"}),
      choice("passage", "both", words_of(kPassages),
             "what passages wait for: both: |V| reaches the speed w. up: V does. down: V "
             "reaches -w"),
      Option::text_of(
          "observable", "functions", "",
          fmt::format("functions of the state for {}. With -scheme hp elements end at their jumps "
                      "and kinks in v: at most 64, the same for all x",
                      cases::takers_of("observable")))
          .called({"function", "functions"}),
      Option::real(
          "accuracy", "", "1e-6", {1e-15, 0.1, true, true},
          "relative error wanted for every scalar, at the given -delta; the discretisation is "
          "refined until the error estimates are below it" +
              usual_accuracies(),
          "six digits are -accuracy 1e-6; double precision allows down to about 1e-14, case by "
          "case")
          .called({"tol", "tolerance", "rtol", "precision", "eps", "error", "digits"}),
  };
  options.insert(options.end(), others.begin(), others.end());
  return options;
}

Option route_option() {
  std::string sentence = "solution method";
  for (const auto& method : cases::solution_methods()) {
    sentence += fmt::format(". {}: {}", method.word, method.sentence);
  }
  return choice("route", cases::solution_methods()[0].word, words_of(cases::solution_methods()),
                sentence)
      .called({"method", "solver", "algorithm"});
}

std::vector<Option> route_and_discretisation() {
  return {
      route_option(),
      choice("scheme", "hp", words_of(kSchemes),
             "discretisation of the velocity. hp: discontinuous Galerkin elements of high order. "
             "upwind: the first-order differences of the paper"),
      Option::integer("degree", "", Range::whole(1, 24),
                      "largest polynomial degree in v of the hp elements; switches refinement off"),
      Option::integer("layers", "", Range::whole(1, 200),
                      "number of elements graded towards v = 0; switches refinement off",
                      "leave it out to have it chosen from the model parameters"),
      Option::integer(
          "noise_degree", "", Range::whole(0, 20),
          "degree in x of the polynomials on groups of noise levels; 0: every level is a node. "
          "Above 0 it switches refinement off"),
      Option::real(
          "noise_grading", "", "2", {0, 100, false, true},
          "grading of the groups of noise levels: a group has at most this many levels for each "
          "level between it and mu_d or mu_s",
          "2 suits most cases"),
      Option::integer("p", "", Range::whole(1, 1e7),
                      "velocities of the upwind scheme per noise step; switches refinement off"),
  };
}

std::vector<Option> method_options() {
  auto all = route_and_discretisation();
  const std::vector<Option> others{
      choice(
          "spectrum_solver", "krylov", words_of(kSpectrumSolvers),
          "krylov: two-sided rational Krylov projection, a few real factorisations for all "
          "frequencies but those whose waves need elements of their own. direct: complex factors "
          "for each frequency, a check that gives the spectrum and the diffusivity"),
      flag("plan",
           "print the systems to assemble, factor and solve, with predicted unknowns, non-zeros, "
           "memory and time, and stop"),
      Option::integer(
          "excursions", "1000000", Range::whole(2, 1e15),
          "number of simulated excursions of -route monte_carlo; of pairs of them without "
          "symmetry, of paths for functions of time, and under Gaussian noise of continuous paths "
          "or with -spring_stiffness of stretches of paths. If -accuracy is given, the simulation "
          "ends when all confidence intervals are small enough",
          "a million gives about three digits")
          .called({"samples", "n_samples", "trials", "paths"}),
      Option::integer(
          "seed", "1", Range::whole(0, 9007199254740992),
          "seed of the random numbers; a seed gives the same results on any number of ranks",
          "any whole number will do"),
      Option::real("horizon", "time", "100", Range::positive(), "end of the trajectory",
                   "take for example 100")
          .called({"duration", "t_max", "t_end", "t_final"}),
      Option::file(
          "checkpoint", Kind::path,
          "checkpoint of a simulation or a sweep, updated as it runs; a run resumes from the file "
          "if it exists. More -excursions extend a finished simulation; a sweep computes the "
          "points that the file lacks"),
  };
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

std::vector<Option> study_options() {
  return {
      choice("study", "none", words_of(kStudies),
             "p: upwind scheme with p = 2, 4, ..., observed order, Richardson extrapolation. "
             "delta: the same for decreasing noise steps, with mu_s on a level and between two. "
             "tau: the limit of white noise, tau -> 0 with delta a fixed share of the deviation. "
             "heuristic: the paper's extrapolation beside converged values. cost: error against "
             "time of all methods"),
      Option::integer("study_steps", "", Range::whole(4, 20),
                      "number of values of p or delta (default 8), or of tau (default 7)",
                      "three values give an order, a fourth its uncertainty"),
      Option::integer("study_repeats", "3", Range::whole(1, 99),
                      "runs of each case of -study cost, of which the median time counts",
                      "an odd number is best"),
  };
}

std::vector<Option> sweep_options() {
  std::vector<Option> options;
  for (const auto& option : effects::model_options()) {
    const bool number = option.kind == Kind::real || option.kind == Kind::integer;
    if (!number) continue;
    options.push_back(numbers(std::string(kSweeps) + option.name, option.unit, option.range,
                              "values of -" + option.name, option.fix));
  }
  options.push_back(
      Option::integer("sweep_ranks", "1", Range::whole(1, 1e6),
                      "MPI ranks that share a point; groups of this size take the points in "
                      "turn",
                      "one is best while a point fits into the memory of one"));
  return options;
}

std::vector<Option> output_options() {
  std::vector<Option> options;
  for (const auto* output : all()) {
    if (output->option.empty()) continue;
    options.push_back(
        Option::file(output->option, Kind::path, output->sentence).called(output->synonyms));
  }
  options.push_back(
      Option::file(
          "compare", Kind::input,
          "compare the results with those of this file: HDF5 or JSON of this program, or CSV with "
          "the columns quantity,argument,value,low,high (95 % confidence intervals). What is to be "
          "computed is taken from the file unless given. Exit status 3 if they disagree")
          .called({"reference", "check"}));
  options.push_back(choice("progress", "auto", words_of(kProgress),
                           "show progress on standard error; auto: if that is a terminal"));
  return options;
}

std::string suggestion_for_word(const Option& option, const std::string& word) {
  const std::string meant = meant_word(option, word);
  if (meant.empty()) return "";
  return suggested(meant, synonyms_of(word, option.name));
}

void check_words(const Option& option, const std::string& value, Problems& problems) {
  const auto given = option.kind == Kind::list ? split(value, ',')
                     : option.adds             ? split(value, '+')
                                               : std::vector{value};
  const std::string must = "must be " + requirement(option);
  if (given.empty()) problems.add(option, value, must, "");
  for (auto word = given.begin(); word != given.end(); ++word) {
    if (std::count(option.words.begin(), option.words.end(), *word) == 0) {
      problems.add(option, *word, must, suggestion_for_word(option, *word));
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
  if (*behind == ',' && !is_list) return "write the number with a decimal point; " + fix;
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
  const bool several = !number && parse_numbers(value) && find("sweep_" + option.name) != nullptr;
  const std::string fix =
      several ? fmt::format("-sweep_{} {} takes several values", option.name, value) : option.fix;
  problems.add(option, value, "must be " + requirement(option),
               number ? option.fix : written_plainly(value, false, fix));
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
    for (const auto* entry : cases::entries()) {
      add("quantities", entry->word, split(entry->synonyms, ','));
    }
    add_words("route", cases::solution_methods());
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

std::string meant_word(const Option& option, const std::string& word) {
  if (const Synonyms* row = synonyms_of(word, option.name)) return row->word;
  const auto* quantity = option.name == "quantities" ? cases::entry_of(word) : nullptr;
  if (quantity != nullptr) return std::string(quantity->word);
  return nearest_word(word, option.words);
}

std::string requirement(const Option& option) {
  std::string words = enumerate(option.words, "or");
  switch (option.kind) {
  case Kind::real: return "a number in " + option.range.text();
  case Kind::integer:
    return "a whole number in " + option.range.text() + (words.empty() ? "" : " or " + words);
  case Kind::list: return "a comma list of " + enumerate(option.words, "and");
  case Kind::numbers:
    return fmt::format("numbers in {} as a,b,c or first:last:count or first:last:count:log",
                       option.range.text());
  case Kind::choice:
  case Kind::flag: return words;
  case Kind::text: return "text";
  case Kind::path:
  case Kind::input: return "a file name";
  }
  return "";
}

std::string allowed(const Option& option) {
  std::string words = fmt::format("{}", fmt::join(option.words, ", "));
  switch (option.kind) {
  case Kind::real:
  case Kind::integer:
  case Kind::numbers: return option.range.text() + (words.empty() ? "" : ", " + words);
  default: return words;
  }
}

const Option* swept_by(const Option& option) {
  return option.name.starts_with(kSweeps) ? find(option.name.substr(kSweeps.size())) : nullptr;
}

std::span<const Group> table() {
  static const std::vector<Group> groups{
      {"Model",
       "Langevin equation of a body with dry friction: dV/dt = X + g + b(V) - F(V) sign(V) in a "
       "sliding phase, V = 0 in a sticking phase, which lasts while |X + g| <= mu_s. Forces are "
       "per unit mass",
       effects::model_options()},
      {"Quantities",
       "What is computed. Only the systems that the quantities need are assembled, factored and "
       "solved",
       quantity_options()},
      {"Method", "How it is computed", method_options()},
      {"Study", "A series of runs that examines the accuracy", study_options()},
      {"Sweep",
       "A run for each combination of the swept values. The last option of this list changes "
       "fastest; points that the model refuses, such as mu_d above mu_s, are left out. -checkpoint "
       "keeps the finished points",
       sweep_options()},
      {"Output", "A table goes to standard output, progress to standard error", output_options()}};
  return groups;
}

std::span<const OtherOption> other_options() {
  static const std::vector<OtherOption> others{
      {"-options_file", "read options from a file, one -name value a line, # for comments",
       "config, input, file"},
      {"-cases",
       "run a case for each line of this file, or of standard input for -. A line has the options "
       "of a case, besides those of the command line, values with blanks in quotes. Each is "
       "answered by a line of JSON: status, then what -summary writes, or message",
       "batch, serve"},
      {"-help", "print all options and stop", "h"},
      {"-help_solvers",
       "print PETSc's options of the solver -slide_, as -slide_pc_type chooses it, and "
       "stop"},
      {"-version", "print the versions of the program and its libraries and stop"},
      {"-reference", "print the table of options in Markdown and stop"},
      {"-reference_json", "print the table of options as JSON for other programs and stop"},
      {"-reference_quantities", "print the tables of quantities and keys in Markdown and stop"},
      {"-man_page", "print the manual page in roff and stop"},
      {"-completion", "print the completion of the command line for bash and stop"},
      {"-slide_...", "PETSc options of the solver for the sliding operator, for example "
                     "-slide_ksp_view, -slide_mat_view binary:FILE, or -slide_pc_type with "
                     "elements or lu (by MUMPS)"},
      {"-null_..., -relax_...", "SLEPc options of the eigensolvers of -route null_vector and of "
                                "relaxation, for example -relax_eps_nev 10 or -null_eps_view"},
      {"-log_view, ...", "PETSc's own options"},
  };
  return others;
}

std::span<const Option> all_options() {
  static const auto all = [] {
    std::vector<Option> options;
    for (const auto& group : table()) {
      options.insert(options.end(), group.options.begin(), group.options.end());
    }
    return options;
  }();
  return all;
}

const Option* find(std::string_view name) {
  for (const auto& option : all_options()) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const auto& other : other_options()) {
    if (other.name.find("...") == std::string::npos) names.push_back(other.name);
  }
  for (const auto& option : all_options()) names.push_back("-" + option.name);
  return names;
}

std::map<std::string, std::string>& stated_places() {
  static std::map<std::string, std::string> places;
  return places;
}

std::string stated_in_file(const std::string& name) {
  const auto found = stated_places().find(name);
  return found == stated_places().end() ? "" : fmt::format(" ({})", found->second);
}

void Problems::add(const Option& option, const std::string& value, const std::string& why,
                   const std::string& fix) {
  constexpr std::size_t longest = 200;  // of values that a message repeats
  const std::string shown = value.size() <= longest ? value : value.substr(0, longest) + "...";
  std::string message =
      fmt::format("-{}{}: {}", option.name, shown.empty() ? "" : " = " + shown, why);
  if (!fix.empty()) message += "; " + fix;
  add(message + stated_in_file(option.name));
}

void Problems::raise() const {
  if (messages_.empty()) return;
  throw BadInput(fmt::format("{}", fmt::join(messages_, "\n")));
}

Settings Settings::read() {
  Settings settings;
  for (const auto& option : all_options()) {
    const auto given = linalg::option_value(option.name);
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

}  // namespace stickslip::cli
