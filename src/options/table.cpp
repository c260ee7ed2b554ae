#include "stickslip/options/table.hpp"

#include <fmt/format.h>

#include "quantities.hpp"
#include "stickslip/support/text.hpp"
#include "words.hpp"

namespace stickslip::options {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr const char* kChosen = "leave it out to have it chosen from -accuracy";

Range positive() { return {0, kInfinity, false, false}; }
Range not_negative() { return {0, kInfinity, true, false}; }
Range whole(double low, double high) { return {low, high, true, true}; }

using Words = std::vector<std::string>;

Option real(const char* name, const char* unit, const char* initial, Range range,
            const char* sentence, const char* fix = kChosen) {
  const std::string allowed = "a number in " + range.text();
  return {name, Kind::real, "number", allowed, unit, initial, range, {}, sentence, fix};
}

Option integer(const char* name, const char* initial, Range range, const char* sentence,
               const char* fix = kChosen, const Words& words = {}) {
  const std::string or_words = words.empty() ? "" : " or " + enumerate(words, "or");
  const std::string allowed = "a whole number in " + range.text() + or_words;
  return {name, Kind::integer, "integer", allowed, "", initial, range, words, sentence, fix};
}

Option choice(const char* name, const char* initial, const Words& words, const char* sentence) {
  return {name, Kind::choice, "word", enumerate(words, "or"), "", initial, {}, words, sentence, ""};
}

Option list(const char* name, const char* initial, const Words& words, const char* sentence) {
  const std::string allowed = "a comma list of " + enumerate(words, "and");
  return {name, Kind::list, "list", allowed, "", initial, {}, words, sentence, ""};
}

Option flag(const char* name, const char* sentence) {
  return {name, Kind::flag, "flag", "yes or no", "", "no", {}, {"yes", "no"}, sentence, ""};
}

Option numbers(const std::string& name, const std::string& unit, Range range,
               const std::string& sentence, const std::string& fix) {
  const std::string allowed = fmt::format(
      "numbers in {} as a,b,c or first:last:count or first:last:count:log", range.text());
  return {name, Kind::numbers, "numbers", allowed, unit, "", range, {}, sentence, fix};
}

Option arguments(const char* name, const char* unit, const char* sentence) {
  return numbers(name, unit, not_negative(), sentence,
                 "negative and missing values mean nothing here");
}

Option text(const char* name, const char* initial, const char* sentence) {
  return {name, Kind::text, "text", "text", "", initial, {}, {}, sentence, ""};
}

Option file(const char* name, Kind kind, const char* sentence) {
  return {name, kind, "file", "a file name", "", "", {}, {}, sentence, ""};
}

std::vector<Option> friction_options() {
  return {
      real("mu_s", "force", "1", positive(), "static friction coefficient",
           "friction must be able to hold the body"),
      real("mu_d", "force", "1", positive(), "dynamic friction coefficient, at most mu_s",
           "for sliding without friction take a small value such as 1e-8"),
      real("mu_s_minus", "force", "", positive(),
           "static friction coefficient against motion towards negative v; that of -mu_s unless "
           "given. Where directions differ, both signs of v are kept",
           "friction must be able to hold the body"),
      real("mu_d_minus", "force", "", positive(),
           "dynamic friction coefficient while v < 0, at most mu_s_minus; that of -mu_d unless "
           "given",
           "for sliding without friction take a small value such as 1e-8"),
      choice("friction", "coulomb", words_of(kFrictionLaws),
             "friction of a sliding body: mu_d at every speed, or mu_d + (mu_s - mu_d) "
             "exp(-(|v|/v_s)^gamma), by direction as these are"),
      real("stribeck_velocity", "velocity", "", positive(),
           "v_s of -friction stribeck, the speeds within which friction falls from mu_s to mu_d",
           "for a fall at once take -friction coulomb"),
      real("stribeck_exponent", "", "1", positive(), "gamma of -friction stribeck",
           "take 1, or 2 for friction that is flat at rest"),
      choice(
          "noise", "ou", {"ou", "telegraph", "file"},
          "the noise X: ou, an Ornstein-Uhlenbeck process on the levels of -delta; telegraph, two "
          "values; file, any birth-death chain"),
  };
}

std::vector<Option> scene_options() {
  std::vector<Option> all = friction_options();
  const std::vector<Option> others{
      real("tau", "time", "1", positive(), "correlation time of -noise ou",
           "for white noise take a small value such as 0.01"),
      real("delta", "force", "0.125", positive(), "step between neighbouring noise levels",
           "the continuous noise is the limit of small steps such as 0.125"),
      integer("noise_levels", "", whole(1, 1e9),
              "levels N of the noise on each side of 0; `full` is the most that there can be, 2 "
              "(deviation/delta)^2. Without "
              "it, the full range is meant, and as much of it is kept as -accuracy needs",
              kChosen, {"full"}),
      real("noise_deviation", "force", "", positive(),
           "standard deviation of X with -noise ou; 1/sqrt(tau) unless given, so that X tends to "
           "white "
           "noise of one strength as tau -> 0",
           "take the standard deviation of the measured force"),
      real("telegraph_amplitude", "force", "", positive(), "a of -noise telegraph, X = +a or -a",
           "take for example 1"),
      real("telegraph_rate", "1/time", "", positive(),
           "rate at which X = +a turns into -a and back: the correlation time is half its inverse",
           "take for example 1"),
      file("noise_file", Kind::input,
           "CSV with the columns x,rate_up,rate_down: the levels of -noise file, rising, with the "
           "rates of jumps to their neighbours; 0 for those below the first and above the last"),
      choice("drag", "linear", words_of(kDragLaws),
             "drag law b(v): -c v, 0, -c v - c3 v^3, or -drag_expression"),
      real("drag_coefficient", "1/time", "1", not_negative(), "c in the drag law",
           "the drag must not grow with the velocity, it would drive the body"),
      real("drag_cubic", "time/length^2", "0", not_negative(), "c3 in the cubic drag law",
           "the drag must not grow with the velocity, it would drive the body"),
      text("drag_expression", "",
           "b(v) of -drag expression in v, mu_s, mu_d, tau, such as \"-v - 0.1*v*abs(v)\"; 0 at "
           "rest, with bounded slopes (kinks are fine, jumps not). It may rise where drag and "
           "friction together still slow a fast body; where it is not odd, both signs of v are "
           "kept, as with a bias"),
      real("bias", "force", "0", {-kInfinity, kInfinity, false, false},
           "constant force added to X, such as the slope of an inclined plane; without symmetry "
           "both signs of v are kept, and everything can be asked for all the same",
           "take for example 0.1"),
      real("v_max", "velocity", "", positive(),
           "cut of the velocity axis; bodies that reach it wait there until the noise falls. "
           "Without it, the largest velocity that matters at -accuracy is taken"),
  };
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

// Where functions are asked for.
std::vector<Option> argument_options() {
  return {
      arguments(
          "lambda", "1/time",
          "values of lambda, as a,b,c or first:last:count or first:last:count:log. With -route "
          "lambda one value, chosen from -accuracy if it is left out"),
      arguments("omega", "1/time", "angular frequencies of spectrum, in the forms of -lambda"),
      arguments(
          "time", "time",
          "times of duration_density, autocorrelation, displacement and expectation, in the forms "
          "of -lambda"),
      arguments("distance", "velocity*time", "path lengths of slip, in the forms of -lambda"),
      arguments("inverse_distance", "1/(velocity*time)",
                "values s of F_slip = E[exp(-s path length)], in the forms of -lambda"),
      arguments("velocity", "velocity", "speeds w > 0 of peak, in the forms of -lambda"),
  };
}

std::vector<Option> question_options() {
  std::vector<Option> all{list(
      "quantities", "sticking,moments,noise_law", words_of(quantity_table()),
      "comma list. sticking: P_stick, P_slide, mean_stick, mean_slide, mean_excursion. "
      "moments: E_V2, E_absV, E_XV, E_V. averages: pi(f), pi(f|stick), pi(f|slide) for each "
      "-observable f, slip_rate = 1/mean_excursion, friction_power = E[F(V) |V|]. noise_law: "
      "P_X_le_mu_s, E_X2. entry_law: the level at which a slide from s+ ends (an array; "
      "without symmetry also entry_law_minus, from s-), f_stick_0. density: the stationary "
      "law as a field "
      "(needs -output). laplace: F_slide, F_stick, F_excursion on -lambda. F_stick: that "
      "alone, from the noise at rest. resolvent: h_plus, h_minus, w_one and for each "
      "-observable u, w_plus, w_minus, pi, mu on -lambda (pi_lambda beside averages). "
      "relaxation: leading eigenvalues of "
      "-L, with symmetry for even and odd functions. spectrum: S_v of V - E[V] on -omega, "
      "S_0, diffusivity = S_0/2, "
      "fwhm, t_corr = 1/fwhm, variance_from_spectrum. duration_density: f_slide, f_stick, "
      "f_excursion and cdf_slide, cdf_stick, cdf_excursion on -time. autocorrelation: C_vv = "
      "E[(V_0 - m)(V_t - m)], m = E[V], on -time. expectation: E[f(Z_t)] from -start for each "
      "-observable on "
      "-time, and its limit pi(f). slip: mean and variance of the path length of a slide "
      "(mean_slip, var_slip) and of its net displacement (mean_slip_net, var_slip_net), f_slip "
      "and cdf_slip of the path length on -distance, F_slip on -inverse_distance. peak, on "
      "-velocity: P_peak = P(the largest speed of a slide > w), mean_first_passage and "
      "mean_first_passage_rest = mean time until |V| first reaches w from the start of a slide "
      "and from rest. displacement: displacement_mean and displacement_variance of int_0^t V "
      "from -start, on -time. trajectory: one simulated path from -start up to "
      "-horizon, to -output or -trajectory. sensitivity: derivatives of every scalar of "
      "sticking, moments and noise_law, as far as these are asked for, with respect to mu_d, "
      "mu_d_minus (if given), tau (at a fixed number of noise levels) and drag_coefficient, "
      "with -friction stribeck also mu_s and stribeck_velocity, by adjoints: "
      "dP_stick_dmu_d and so on; between two noise levels no threshold of rest counts")};
  const auto arguments = argument_options();
  all.insert(all.end(), arguments.begin(), arguments.end());
  const std::vector<Option> others{
      text("start", "s+",
           "at time 0 of expectation, displacement and trajectory: s+, s-, x,v with x a noise "
           "level, rest (X in "
           "its stationary distribution, V = 0) or stationary"),
      text("observable", "",
           "functions of the state for averages, resolvent and expectation, separated by "
           "semicolons: 1, x, "
           "v, v^2, |v|, stick, slide, |x|<=mu_s, or expressions in x, y, v, mu_s, mu_d such as "
           "\"x*v; abs(v) > 0.5\"; with -scheme hp elements end at jumps and kinks in v, up to 64 "
           "that "
           "are the same for all x"),
      real("accuracy", "", "1e-6", {1e-15, 0.1, true, true},
           "relative error wanted for every scalar asked for, at the given delta",
           "double precision allows down to about 1e-14, case by case"),
  };
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

std::vector<Option> method_options() {
  return {
      choice("scheme", "hp", words_of(kSchemes),
             "discretisation in v: hp discontinuous Galerkin elements, or the first-order upwind "
             "differences of the paper"),
      integer("degree", "", whole(1, 24),
              "largest polynomial degree of the hp elements; fixing it switches refinement off"),
      integer("layers", "", whole(1, 200),
              "elements graded towards v = 0; fixing it switches refinement off",
              "leave it out to have it chosen from the scene"),
      integer("noise_degree", "", whole(0, 20),
              "degree of the polynomials in x that stand for groups of noise levels; 0: every "
              "level is a node. Fixing it above 0 switches refinement off"),
      real("noise_grading", "", "2", {0, 100, false, true},
           "levels of a group for each level of distance from mu_d and mu_s, towards which groups "
           "shrink",
           "2 suits most scenes"),
      integer("p", "", whole(1, 1e7),
              "points of the upwind scheme per noise step; fixing it switches refinement off"),
      choice("spectrum_solver", "krylov", words_of(kSpectrumSolvers),
             "krylov: two-sided rational Krylov projection, a few real factorisations for all "
             "frequencies. direct: one complex factorisation for each frequency "
             "(stickslip-complex), to check it; gives S_v, S_0 and diffusivity"),
      choice(
          "transient_solver", "krylov", words_of(kTransientSolvers),
          "krylov: reduced models, all times at once. stepping: the backward Kolmogorov equation "
          "by PETSc's time steppers, to check it (-backward_ts_...)"),
      choice(
          "route", "excursion", words_of(kRoutes),
          "excursion: one transposed solve with the sliding operator gives the whole stationary "
          "law. The others work on both signs of v and check it. lambda: lambda u_lambda for one "
          "small lambda. hitting: mean hitting times. null_vector: the left null vector of the "
          "generator, by SLEPc. fluid_queue: b = 0 without any discretisation in v. monte_carlo: "
          "simulated excursions, with 95 % confidence intervals"),
      flag("plan",
           "print what would be assembled, factored and solved, with unknowns, non-zeros, memory "
           "and time predicted by the analysis phase of the solver, and stop"),
      integer(
          "excursions", "1000000", whole(2, 1e15),
          "number of simulated excursions with -route monte_carlo, without symmetry of pairs of "
          "them and with functions of time of paths; with -accuracy it stops "
          "before that when every interval is small enough",
          "a million gives about three digits"),
      integer(
          "seed", "1", whole(0, 9007199254740992),
          "seed of what is simulated; the same seed gives the same numbers on any number of ranks",
          "any whole number will do"),
      real("horizon", "time", "100", positive(), "end of the trajectory", "take for example 100"),
      file("checkpoint", Kind::path,
           "go on with the simulation of this file if it exists, and keep it there every few "
           "seconds; more -excursions later add to it. With a sweep: keep every point there as it "
           "is finished, and do only what the file does not hold yet"),
  };
}

std::vector<Option> study_options() {
  return {
      choice("study", "none", words_of(kStudies),
             "p: the upwind scheme on p = 2, 4, ..., its observed order and Richardson's limit. "
             "delta: falling noise steps with mu_s on a level and between two, observed order and "
             "repeated Richardson's limit. heuristic: the extrapolation of the paper beside "
             "converged values. cost: error against time of all methods"),
      integer("study_steps", "", whole(4, 20),
              "length of the series: number of values of p or delta (default 8)",
              "three values tell an order, a fourth how sure it is"),
      integer("study_repeats", "3", whole(1, 99),
              "repetitions of each run of -study cost, of which the median time is taken",
              "an odd number is best"),
  };
}

std::vector<Option> sweep_options() {
  std::vector<Option> options;
  for (const auto& option : scene_options()) {
    const bool number = option.kind == Kind::real || option.kind == Kind::integer;
    if (!number) continue;
    options.push_back(numbers("sweep_" + option.name, option.unit, option.range,
                              "values of -" + option.name, option.fix));
  }
  options.push_back(integer("sweep_ranks", "1", whole(1, 1e6),
                            "ranks that share the work of a point; groups of that many take the "
                            "points one after the other",
                            "one is best while a point fits into the memory of one"));
  return options;
}

std::vector<Option> output_options() {
  return {
      file("summary", Kind::path, "write everything as JSON to this file"),
      file("output", Kind::path,
           "write everything and the fields as HDF5 to this file; with density also FILE.xdmf, "
           "which ParaView opens"),
      file("study_csv", Kind::path,
           "write every scalar of every run of a study as CSV to this file"),
      file("sweep_csv", Kind::path,
           "write a row for each point of a sweep as CSV to this file: its values, every scalar "
           "with its error, and how it ended"),
      file("trajectory", Kind::path, "write the trajectory as CSV (time, x, y, v) to this file"),
      file("compare", Kind::input,
           "hold the results against the values of this file: HDF5 or JSON of this program, or CSV "
           "with columns quantity,argument,value,low,high (95 % intervals). Without -quantities, "
           "-lambda, -omega or -time, those of the file are taken. Exit status 3 when they "
           "disagree (family-wise level 1e-3)"),
      choice("progress", "auto", words_of(kProgress),
             "show what is being done; auto: when standard error is a terminal"),
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

std::span<const Group> table() {
  static const std::vector<Group> groups{
      {"Scene",
       "What is simulated: dV/dt = X + b(V) - mu_d sign(V) while the body slides, V = 0 while it "
       "sticks and |X| <= mu_s; forces are per unit mass",
       scene_options()},
      {"Question", "What is asked for; only what is named is assembled, factored and solved",
       question_options()},
      {"Method", "How it is computed", method_options()},
      {"Study", "A series of runs that looks at the accuracy itself", study_options()},
      {"Sweep",
       "A run for each combination of the values given, as a,b,c or first:last:count or "
       "first:last:count:log; the last option of this list changes fastest. -checkpoint keeps what "
       "is finished",
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
      {"-reference", "print the reference page in Markdown and stop"},
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
