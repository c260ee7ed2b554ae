#include "stickslip/options/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "quantities.hpp"
#include "stickslip/support/infinity.hpp"
#include "stickslip/support/text.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

constexpr const char* kChosen = "leave it out to have it chosen from -accuracy";
constexpr std::string_view kSweeps = "sweep_";

Range positive() { return {0, kInfinity, false, false}; }
Range not_negative() { return {0, kInfinity, true, false}; }
Range whole(double low, double high) { return {low, high, true, true}; }

using Words = std::vector<std::string>;

Option real(const char* name, const char* unit, const char* initial, Range range,
            const char* sentence, const char* fix = kChosen) {
  return {name, Kind::real, "number", unit, initial, range, {}, sentence, fix};
}

Option integer(const char* name, const char* initial, Range range, const char* sentence,
               const char* fix = kChosen, const Words& words = {}) {
  return {name, Kind::integer, "integer", "", initial, range, words, sentence, fix};
}

Option choice(const char* name, const char* initial, const Words& words, const char* sentence) {
  return {name, Kind::choice, "word", "", initial, {}, words, sentence, ""};
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

Option arguments(const char* name, const char* unit, const char* sentence) {
  return numbers(name, unit, not_negative(), sentence,
                 "negative and missing values mean nothing here");
}

Option text(const char* name, const char* form, const char* initial, const char* sentence) {
  return {name, Kind::text, form, "", initial, {}, {}, sentence, ""};
}

Option file(const char* name, Kind kind, const char* sentence) {
  return {name, kind, "file", "", "", {}, {}, sentence, ""};
}

std::vector<Option> friction_options() {
  return {
      real("mu_s", "force", "1", positive(),
           "static friction coefficient: a body at rest sticks while the force on it is at most "
           "mu_s",
           "friction must be able to hold the body"),
      real("mu_d", "force", "1", not_negative(), "dynamic friction coefficient, at most mu_s",
           "friction must not drive the body"),
      real("mu_s_minus", "force", "", positive(),
           "static friction coefficient against motion towards negative v; mu_s unless given. "
           "Where the directions differ, both velocity branches are computed",
           "friction must be able to hold the body"),
      real("mu_d_minus", "force", "", not_negative(),
           "dynamic friction coefficient while v < 0, at most mu_s_minus; mu_d unless given",
           "friction must not drive the body"),
      choice("friction", "coulomb", words_of(kFrictionLaws),
             "friction law. coulomb: F = mu_d at every speed. stribeck: F(v) = mu_d + (mu_s - "
             "mu_d) exp(-(|v|/v_s)^gamma), with the coefficients of each direction"),
      real("stribeck_velocity", "velocity", "", positive(),
           "Stribeck velocity v_s: friction falls from mu_s to mu_d over speeds of this size",
           "for a fall at once take -friction coulomb"),
      real("stribeck_exponent", "", "1", positive(), "exponent gamma of -friction stribeck",
           "take 1, or 2 for friction that is flat at rest"),
  };
}

std::vector<Option> noise_options() {
  return {
      choice("noise", "ou", {"ou", "telegraph", "file"},
             "noise X. ou: the chain of the paper, which tends to the Ornstein-Uhlenbeck process "
             "as -delta -> 0. telegraph: two levels. file: any birth-death chain"),
      real("tau", "time", "1", positive(), "correlation time of -noise ou",
           "for white noise take a small value such as 0.01"),
      real("delta", "force", "0.125", positive(), "step between neighbouring noise levels",
           "the continuous noise is the limit of small steps such as 0.125"),
      integer(
          "delta_per_mu_s", "", whole(1, 1e6),
          "number n of noise steps up to mu_s, in the place of -delta: delta = mu_s/n puts mu_s "
          "on a level, so that results are continuous in mu_s",
          "take for example 8"),
      integer("noise_levels", "", whole(1, 1e9),
              "number N of noise levels on each side of 0; `full` is the largest possible, 2 "
              "(deviation/delta)^2. Unless given, the noise is that of full, truncated where "
              "-accuracy allows it",
              kChosen, {"full"}),
      real("noise_deviation", "force", "", positive(),
           "standard deviation of X with -noise ou; 1/sqrt(tau) unless given, with which X tends "
           "to white noise of fixed intensity as tau -> 0",
           "take the standard deviation of the measured force"),
      real("telegraph_amplitude", "force", "", positive(),
           "amplitude a of -noise telegraph, X = a or -a", "take for example 1"),
      real("telegraph_rate", "1/time", "", positive(),
           "rate of the jumps between a and -a; the correlation time is 1/(2 rate)",
           "take for example 1"),
      file("noise_file", Kind::input,
           "CSV with the columns x,rate_up,rate_down: the levels of -noise file in rising order, "
           "and the rates of jumps to the next level up and down, 0 at the ends"),
  };
}

std::vector<Option> drag_options() {
  return {
      choice("drag", "linear", words_of(kDragLaws),
             "drag law b(v): -c v, 0, -c v - c3 v^3, or the formula of -drag_expression"),
      real("drag_coefficient", "1/time", "1", not_negative(), "c of the drag law",
           "the drag must not grow with the velocity, it would drive the body"),
      real("drag_cubic", "time/length^2", "0", not_negative(), "c3 of the cubic drag law",
           "the drag must not grow with the velocity, it would drive the body"),
      text("drag_expression", "formula", "",
           "b(v) of -drag expression, such as \"-v - 0.1*v*abs(v)\". b(0) = 0, and slopes are "
           "bounded: kinks are allowed, jumps are not. b may rise where friction and drag together "
           "still slow a fast body. Unless b is odd, both velocity branches are computed"),
      real("bias", "force", "0", {-kInfinity, kInfinity, false, false},
           "constant force g added to X, such as the weight along an inclined plane. It breaks the "
           "symmetry: both velocity branches are computed",
           "take for example 0.1"),
      real("v_max", "velocity", "", positive(),
           "truncation velocity: bodies that reach it wait there until the noise falls. Unless "
           "given, the largest velocity that matters at -accuracy"),
      real(
          "speed_limit", "velocity", "", positive(),
          "largest speed of the body: forces that would drive it beyond are lost, as the inflow of "
          "a full buffer is. A part of the model, where -v_max only truncates it",
          "leave it out for a body that is as fast as forces make it"),
  };
}

std::vector<Option> model_options() {
  std::vector<Option> all;
  for (const auto& part : {friction_options(), noise_options(), drag_options()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::vector<Option> quantity_options() {
  return {
      list("quantities", "sticking,moments,noise_law", quantity_words(), "quantities to compute"),
      arguments("lambda", "1/time",
                "arguments of the Laplace transforms and the resolvent (laplace, F_stick, "
                "resolvent). With -route lambda one positive value, chosen from -accuracy unless "
                "given"),
      arguments("omega", "1/time", "angular frequencies of spectrum"),
      arguments("time", "time",
                "times of duration_density, autocorrelation, displacement and expectation"),
      arguments("distance", "velocity*time", "path lengths > 0 of slip, for f_slip and cdf_slip"),
      arguments("inverse_distance", "1/(velocity*time)",
                "arguments s of the Laplace transform F_slip of slip"),
      arguments("velocity", "velocity", "speeds w > 0 of peak"),
      text("start", "state", "s+", "state at time 0 of expectation, displacement and trajectory"),
      text("observable", "functions", "",
           "functions of the state for averages, resolvent and expectation. With -scheme hp "
           "elements end at their jumps and kinks in v: at most 64, the same for all x"),
      real("accuracy", "", "1e-6", {1e-15, 0.1, true, true},
           "relative error wanted for every scalar, at the given -delta; the discretisation is "
           "refined until the error estimates are below it",
           "double precision allows down to about 1e-14, case by case"),
  };
}

std::vector<Option> discretisation_options() {
  return {
      choice("scheme", "hp", words_of(kSchemes),
             "discretisation of the velocity. hp: discontinuous Galerkin elements of high order. "
             "upwind: the first-order differences of the paper"),
      integer("degree", "", whole(1, 24),
              "largest polynomial degree in v of the hp elements; switches refinement off"),
      integer("layers", "", whole(1, 200),
              "number of elements graded towards v = 0; switches refinement off",
              "leave it out to have it chosen from the model parameters"),
      integer("noise_degree", "", whole(0, 20),
              "degree in x of the polynomials on groups of noise levels; 0: every level is a node. "
              "Above 0 it switches refinement off"),
      real("noise_grading", "", "2", {0, 100, false, true},
           "grading of the groups of noise levels: a group has at most this many levels for each "
           "level between it and mu_d or mu_s",
           "2 suits most cases"),
      integer("p", "", whole(1, 1e7),
              "velocities of the upwind scheme per noise step; switches refinement off"),
  };
}

std::vector<Option> method_options() {
  std::vector<Option> all{
      choice("route", "excursion", words_of(kRoutes),
             "solution method. excursion: one transposed solve gives the stationary distribution. "
             "The others check it. lambda: lambda u_lambda for small lambda. hitting: mean hitting "
             "times. null_vector: left null vector of the generator. fluid_queue: b = 0. "
             "monte_carlo: simulation")};
  const auto discretisation = discretisation_options();
  all.insert(all.end(), discretisation.begin(), discretisation.end());
  const std::vector<Option> others{
      choice(
          "spectrum_solver", "krylov", words_of(kSpectrumSolvers),
          "krylov: two-sided rational Krylov projection, a few real factorisations for all "
          "frequencies but those whose waves need elements of their own. direct: complex factors "
          "for each frequency, a check that gives S_v, S_0 and diffusivity"),
      choice("transient_solver", "krylov", words_of(kTransientSolvers),
             "krylov: reduced models for all times at once. stepping: the backward Kolmogorov "
             "equation by PETSc's time steppers (-backward_ts_...), a check"),
      flag("plan",
           "print the systems to assemble, factor and solve, with predicted unknowns, non-zeros, "
           "memory and time, and stop"),
      integer("excursions", "1000000", whole(2, 1e15),
              "number of simulated excursions of -route monte_carlo; of pairs of them without "
              "symmetry, of paths for functions of time. If -accuracy is given, the simulation "
              "ends when all confidence intervals are small enough",
              "a million gives about three digits"),
      integer("seed", "1", whole(0, 9007199254740992),
              "seed of the random numbers; a seed gives the same results on any number of ranks",
              "any whole number will do"),
      real("horizon", "time", "100", positive(), "end of the trajectory", "take for example 100"),
      file("checkpoint", Kind::path,
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
             "heuristic: the paper's extrapolation beside converged values. cost: error against "
             "time of all methods"),
      integer("study_steps", "", whole(4, 20), "number of values of p or delta (default 8)",
              "three values give an order, a fourth its uncertainty"),
      integer("study_repeats", "3", whole(1, 99),
              "runs of each case of -study cost, of which the median time counts",
              "an odd number is best"),
  };
}

std::vector<Option> sweep_options() {
  std::vector<Option> options;
  for (const auto& option : model_options()) {
    const bool number = option.kind == Kind::real || option.kind == Kind::integer;
    if (!number) continue;
    options.push_back(numbers(std::string(kSweeps) + option.name, option.unit, option.range,
                              "values of -" + option.name, option.fix));
  }
  options.push_back(integer("sweep_ranks", "1", whole(1, 1e6),
                            "MPI ranks that share a point; groups of this size take the points in "
                            "turn",
                            "one is best while a point fits into the memory of one"));
  return options;
}

std::vector<Option> output_options() {
  return {
      file("summary", Kind::path,
           "write results, error estimates, cost and provenance as JSON to this file"),
      file("output", Kind::path,
           "write results and fields as HDF5 to this file; with density also FILE.xdmf, which "
           "ParaView opens"),
      file("study_csv", Kind::path,
           "write every scalar of every run of a study as CSV to this file"),
      file("sweep_csv", Kind::path,
           "write a row for each point of a sweep as CSV to this file: swept values, every scalar "
           "with its error estimate, status"),
      file("trajectory", Kind::path,
           "write the trajectory as CSV with the columns time,x,y,v to this file"),
      file(
          "compare", Kind::input,
          "compare the results with those of this file: HDF5 or JSON of this program, or CSV with "
          "the columns quantity,argument,value,low,high (95 % confidence intervals). What is to be "
          "computed is taken from the file unless given. Exit status 3 if they disagree"),
      choice("progress", "auto", words_of(kProgress),
             "show progress on standard error; auto: if that is a terminal"),
  };
}

}  // namespace

bool Range::contains(double value) const {
  return (low_included ? value >= low : value > low) &&
         (high_included ? value <= high : value < high);
}

std::string Range::text() const {
  return fmt::format("{}{:g}, {:g}{}", low_included ? '[' : '(', low, high,
                     high_included ? ']' : ')');
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

std::span<const Form> forms() {
  static const std::vector<Form> all{
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

std::span<const Group> table() {
  static const std::vector<Group> groups{
      {"Model",
       "Langevin equation of a body with dry friction: dV/dt = X + g + b(V) - F(V) sign(V) in a "
       "sliding phase, V = 0 in a sticking phase, which lasts while |X + g| <= mu_s. Forces are "
       "per unit mass",
       model_options()},
      {"Quantities",
       "What is computed. Only the systems that the quantities need are assembled, factored and "
       "solved",
       quantity_options()},
      {"Method", "How it is computed", method_options()},
      {"Study", "A series of runs that examines the accuracy", study_options()},
      {"Sweep",
       "A run for each combination of the swept values. The last option of this list changes "
       "fastest; -checkpoint keeps the finished points",
       sweep_options()},
      {"Output", "A table goes to standard output, progress to standard error", output_options()}};
  return groups;
}

std::span<const OtherOption> other_options() {
  static const std::vector<OtherOption> others{
      {"-options_file", "read options from a file, one -name value a line, # for comments"},
      {"-help", "print all options and stop"},
      {"-help_solvers",
       "print PETSc's options of the solver -slide_, as -slide_pc_type chooses it, and "
       "stop"},
      {"-version", "print the versions of the program and its libraries and stop"},
      {"-reference", "print the table of options in Markdown and stop"},
      {"-reference_quantities", "print the tables of quantities and keys in Markdown and stop"},
      {"-man_page", "print the manual page in roff and stop"},
      {"-completion", "print the completion of the command line for bash and stop"},
      {"-slide_...", "PETSc options of the solver for the sliding operator, for example "
                     "-slide_ksp_view, or -slide_pc_type with elements or lu (by MUMPS)"},
      {"-null_..., -relax_...", "SLEPc options of the eigensolvers of -route null_vector and of "
                                "relaxation, for example -relax_eps_nev 10 or -null_eps_view"},
      {"-log_view, ...", "PETSc's own options"},
  };
  return others;
}

std::span<const ExitMeaning> exit_meanings() {
  static const std::vector<ExitMeaning> meanings{
      {0, "done"},
      {1, "other error"},
      {2, "bad input"},
      {3, "accuracy not reached or a solver failed (what was reached is still written)"},
      {4, "would not fit in memory"}};
  return meanings;
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
