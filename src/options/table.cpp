#include "stickslip/options/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "stickslip/catalogue/entry.hpp"
#include "stickslip/effects/model_options.hpp"
#include "stickslip/outputs/output.hpp"
#include "stickslip/support/text.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

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
Option argument_option(const catalogue::Argument& argument) {
  std::string sentence =
      fmt::format("{} of {}", argument.sentence, catalogue::takers_of(argument.option));
  if (!argument.besides.empty()) sentence += fmt::format(". {}", argument.besides);
  return numbers(std::string(argument.option), std::string(argument.unit),
                 {argument.low, argument.high, argument.low_included, false}, sentence,
                 fmt::format("take for example {}", argument.example))
      .called(split(argument.synonyms, ','));
}

// Of quantities that have an accuracy of their own where -accuracy is not given.
std::string usual_accuracies() {
  std::string text;
  for (const auto* entry : catalogue::entries()) {
    if (entry->usual_accuracy == 0) continue;
    text += fmt::format("{} {:g} with {}", text.empty() ? ". Unless given, it is" : ",",
                        entry->usual_accuracy, entry->word);
  }
  return text;
}

std::vector<Option> quantity_options() {
  Words words;
  for (const auto* entry : catalogue::entries()) words.emplace_back(entry->word);
  std::vector<Option> options{
      list("quantities", "sticking,moments,noise_law", words, "quantities to compute")
          .called({"q", "compute", "observables"}),
  };
  for (const auto* argument : catalogue::arguments()) options.push_back(argument_option(*argument));
  const std::vector<Option> others{
      Option::text_of("start", "state", "s+", "state at time 0 of " + catalogue::takers_of("start"))
          .called({"x0", "v0", "initial", "initial_state"}),
      choice("passage", "both", words_of(kPassages),
             "what passages wait for: both: |V| reaches the speed w. up: V does. down: V "
             "reaches -w"),
      Option::text_of(
          "observable", "functions", "",
          fmt::format("functions of the state for {}. With -scheme hp elements end at their jumps "
                      "and kinks in v: at most 64, the same for all x",
                      catalogue::takers_of("observable")))
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
  for (const auto& method : catalogue::solution_methods()) {
    sentence += fmt::format(". {}: {}", method.word, method.sentence);
  }
  return choice("route", catalogue::solution_methods()[0].word,
                words_of(catalogue::solution_methods()), sentence)
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
          "symmetry, of paths for functions of time. If -accuracy is given, the simulation "
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
  for (const auto* output : outputs::all()) {
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

}  // namespace

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

}  // namespace stickslip::options
