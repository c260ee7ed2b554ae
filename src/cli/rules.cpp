#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "reading.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/case/duration_rows.hpp"
#include "stickslip/case/force_rows.hpp"
#include "stickslip/case/passage_rows.hpp"
#include "stickslip/cli/output.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/simulation/walk.hpp"

namespace stickslip::cli {
namespace {

using cases::SolutionMethod;

/// The rules that relate options to one another. Each is a row: options, when it counts, message.
class Rules {
 public:
  Rules(Settings& settings, Request& request)
      : settings_(settings), r_(request), q_(request.question) {}

  // Options of effects that none of those in use knows, each by the first effect that does.
  void of_other_effects() {
    std::set<std::string> seen;
    const bool noisy = !r_.scene.noise.name.empty();
    warn({"noise"}, !noisy);
    for (const auto* choice : effects::choices()) {
      const auto& word = choice->word_in(r_.scene);
      for (const auto* effect : choice->effects) {
        for (const auto& [option, refused, example] : effect->parameters) {
          if (!seen.insert(option.name).second) continue;
          if (!effects::is_idle(r_.scene, option.name)) continue;
          if (word.empty()) {
            warn({option.name.c_str()}, true);
            continue;
          }
          warn({option.name.c_str()}, !refused, fmt::format("with -{} {}", choice->option, word));
          refuse({option.name.c_str()}, refused,
                 fmt::format("belongs to -{0} {1}, and -{0} is {2}", choice->option, effect->word,
                             word),
                 fmt::format("add -{} {}, or leave it out", choice->option, effect->word));
        }
      }
    }
  }

  // Options without effect.
  void unused() {
    const bool simulates = method_.simulates, swept = sweeps(settings_);
    const std::string no_simulation = "without " + routes_that(&SolutionMethod::simulates, true);
    warn({"excursions"}, !simulates, no_simulation);
    warn({"seed"}, !simulates && !asked("seed"));
    warn({"checkpoint"}, !simulates && !swept, no_simulation + " or a sweep");
    warn({"sweep_ranks"}, !swept, "without a sweep");
    warn({"study_steps", "study_repeats"}, !study_, "without -study");
    unused_outputs(r_.plan_only ? Subject::plan
                   : study_     ? Subject::study
                   : swept      ? Subject::sweep
                                : Subject::run);
    for (const char* option : {"observable", "start", "horizon", "spectrum_solver", "passage",
                               "force_file", "force_interpolation", "force_scale", "force_rest",
                               "sample_layout", "sample_step", "force_gravity"}) {
      warn({option}, !asked(option));
    }
    const bool lifts = r_.scene.force && !r_.scene.force->load.empty();
    warn({"force_gravity"}, asked("force_gravity") && !lifts,
         "without a column vertical in -force_file");
    for (const auto* argument : cases::arguments()) {
      const std::string option(argument->option);
      const bool of_method = method_.small_lambda && option == "lambda";
      warn({option.c_str()}, !of_method && !asked(option));
    }
  }

  // Options that exclude one another.
  void conflicts() {
    const bool hp = r_.method.scheme == Scheme::hp;
    const std::string no_choice = fmt::format("does not apply to -route {}", method_.word);
    refuse({"route"}, !method_.without_drag.empty() && !r_.scene.process(1).drag.is_none(),
           fmt::format("needs a model without drag, b = 0, and Coulomb friction: {}",
                       method_.without_drag),
           "add -drag none, leave -friction out, or take -route excursion");
    refuse({"speed_limit"}, settings_.has("v_max"), "does not go with -v_max", "leave one out");
    refuse({"speed_limit"}, q_.wants(cases::kGivenForce.quantity),
           "does not bound the motion under a given force", "leave it out");
    refuse({"v_max", "speed_limit"}, !method_.bounds_speed, no_choice,
           "leave it out, or take " + routes_that(&SolutionMethod::bounds_speed, true));
    refuse({"scheme", "degree", "layers", "noise_degree", "noise_grading", "p"},
           !method_.discretises_velocity, no_choice + ", which does not discretise the velocity",
           "leave it out");
    refuse({"degree", "layers", "noise_degree", "noise_grading"}, !hp, "belongs to -scheme hp",
           "leave it out, or take -scheme hp");
    const bool far = !r_.scene.process(1).noise.neighbours_only();
    refuse({"noise_degree", "noise_grading"}, far,
           "gathers levels of a noise that jumps to neighbours alone, and this one jumps further",
           "leave it out");
    refuse({"p"}, hp, "belongs to -scheme upwind", "leave it out, or take -scheme upwind");
    refuse({"route", "scheme", "degree", "layers", "noise_degree", "noise_grading", "p", "v_max",
            "compare", "checkpoint", "noise_levels"},
           study_, "is chosen by -study itself", "leave it out");
    const bool of_steps =
        r_.study.kind == StudyKind::steps || r_.study.kind == StudyKind::heuristic;
    refuse({"study"}, of_steps && !effects::noises().knows(r_.scene, "delta"),
           "decreases -delta, which -noise " + r_.scene.noise.name + " does not have",
           "leave it out, or take -noise ou");
    white_noise();
    refuse({"plan"}, r_.plan_only && study_, "predicts one run, not a study", "leave -study out");
  }

  // What asks for levels where there are none.
  void of_continuous_paths() {
    if (r_.scene.projector() == nullptr || !settings_.sound()) return;
    const std::string option =
        r_.scene.spring ? "-spring_stiffness" : "-noise " + r_.scene.noise.name;
    const auto knows_delta = [](const auto* effect) { return effect->knows("delta"); };
    std::string way = "take a chain, which lattice(delta) of such a noise makes in Python";
    if (r_.scene.spring) {
      way = "leave -spring_stiffness out";
    } else if (std::ranges::all_of(effects::noises().all_in(r_.scene), knows_delta)) {
      way = fmt::format("give -delta, such as {:.3g}, for levels", r_.scene.delta);
    }
    const std::string why = "needs a noise of levels alone, which " + option + " has not";
    const bool solved = r_.method.route == Route::excursion && r_.method.scheme == Scheme::hp,
               simulated = method_.simulates;
    report("route", !solved && !simulated, why, "leave it out, or " + way);
    report("study", study_, why, "leave it out, or " + way);
    report("accuracy",
           simulated && r_.scene.noise.gaussian && q_.accuracy_given &&
               q_.accuracy < 2 * simulation::kStepError,
           fmt::format("is not reached by simulated paths of {}, whose steps leave {:g}", option,
                       simulation::kStepError),
           fmt::format("take {:g} or more", 2 * simulation::kStepError));
    const auto of_levels = wanted([simulated](const auto& entry) {
      return simulated ? !entry.by_excursion : entry.of_levels;
    });
    report(
        "quantities", !of_levels.empty(),
        simulated && r_.scene.spring
            ? fmt::format("asks for {}, which are not simulated with {}",
                          enumerate(of_levels, "and"), option)
            : fmt::format("asks for {}, which are {} for noises of levels alone, and {} has none",
                          enumerate(of_levels, "and"), simulated ? "simulated" : "found", option),
        "leave that out, or " + way);
    const bool starts = std::ranges::any_of(cases::entries(), [this](const auto* entry) {
      return q_.wants(entry->quantity) && entry->takes("start");
    });
    const bool state = q_.start.kind == model::Start::Kind::state;
    report("start", starts && state && !q_.start.p,
           fmt::format("is one level, and {} has none", option),
           "add -start rest or -start stationary");
    of_springs();
    const bool durations =
        q_.wants(cases::kPhaseDurations.quantity) || q_.wants(Quantity::duration_density);
    report("time", r_.scene.noise.gaussian && durations && std::ranges::count(q_.time, 0.0) > 0,
           "includes 0, where the density of sticking durations is infinite: noise of continuous "
           "paths lets bodies that stop near mu_s go on at once",
           "take times from above 0, for example 0.01:10:10:log");
    if (!r_.scene.meant().starts_at_balance()) return;
    const std::string at_once =
        "mu_d = mu_s, where noise of continuous paths brings bodies to rest "
        "infinitely often at once";
    const auto of_phases = wanted(
        [](const auto& entry) { return entry.of_phases && entry.quantity != Quantity::sticking; });
    report("quantities", !of_phases.empty(),
           fmt::format("asks for {}, but {}", enumerate(of_phases, "and"), at_once),
           "leave that out, or take a smaller -mu_d");
    if (q_.wants(Quantity::sticking)) {
      r_.warnings.push_back("mean durations are left out: " + at_once + ", so that they are 0");
    }
  }

  // What loses its meaning where a spring holds the body.
  void of_springs() {
    if (!r_.scene.spring) return;
    report("spring_stiffness", !method_.simulates && !r_.scene.solvable(),
           fmt::format("takes more than {} pairs of a force and a position",
                       model::Spring::kMostPairs),
           "take fewer levels, less friction, or -route monte_carlo");
    report("quantities", q_.wants(Quantity::sensitivity) && !method_.simulates,
           "asks for sensitivity, and derivatives are not found for a body on a spring",
           "leave that out, or leave -spring_stiffness out");
    const auto travels = wanted([](const auto& entry) { return entry.of_travel; });
    report("quantities", !travels.empty(),
           fmt::format("asks for {}, and a spring keeps the body in one place: its displacement "
                       "does not grow with time",
                       enumerate(travels, "and")),
           "leave that out");
    report("start",
           q_.wants(cases::kPassageTimeDistribution.quantity) && q_.start.p &&
               !r_.scene.noise.gaussian,
           "has paths that reach the speed all at once, before the first jump of the noise: the "
           "distribution of passage times from a state of a spring is found for -noise ou alone",
           "take first_passage or passage_transform, or -start stationary");
  }

  // What the quantities need, or exclude.
  void needs() {
    using enum Quantity;
    const bool derivable = q_.wants(sticking) || q_.wants(moments) || q_.wants(noise_law);
    const bool others = std::any_of(q_.quantities.begin(), q_.quantities.end(), [](Quantity q) {
      return q != sticking && q != moments && q != noise_law;
    });
    const bool one_lambda = q_.lambda.empty() || (q_.lambda.size() == 1 && q_.lambda[0] != 0);
    require("observable", (q_.wants(resolvent) || q_.wants(expectation)) && q_.observables.empty(),
            "asks for averages of functions of the state, but none are given",
            "add for example -observable \"v^2; stick\"");
    require("force_file", q_.wants(cases::kGivenForce.quantity) && !r_.scene.force,
            "asks for the motion under a given force, but none is given",
            "add for example -force_file record.csv");
    distances();
    require_file(density, "density, a field,");
    require_file(trajectory, "a trajectory,");
    report("quantities", q_.wants(sensitivity) && !derivable,
           "asks for derivatives (sensitivity), but for no scalars to differentiate",
           "add sticking, moments or noise_law");
    require_sticking();
    require_own();
    require_arguments();
    report("quantities", study_ && !to_white_noise_ && others,
           "must be sticking, moments and noise_law, or some of these, in a study",
           "leave the others out");
    report("lambda", method_.small_lambda && !one_lambda,
           fmt::format("must be one positive number with -route {}", method_.word),
           "leave it out to have it chosen from -accuracy");
  }

 private:
  using Options = std::initializer_list<const char*>;

  // Outputs that are not written of what the program does. The plan of a run that needs a file for
  // a field takes the name of that file.
  void unused_outputs(Subject subject) {
    for (const auto* output : all()) {
      const auto& of = output->subjects;
      const bool needed = std::any_of(output->fields.begin(), output->fields.end(),
                                      [this](Quantity field) { return q_.wants(field); });
      if (of.contains(subject) || needed) continue;
      const char* elsewhere = of.contains(Subject::sweep)   ? "without a sweep"
                              : of.contains(Subject::study) ? "without -study"
                                                            : "without -plan";
      const char* here = subject == Subject::plan ? "with -plan" : "with -study";
      warn({output->option.c_str()}, true, of.contains(Subject::run) ? here : elsewhere);
    }
  }

  // What is no number of the table needs a file of an output that holds it.
  void require_file(Quantity field, const char* what) {
    std::vector<std::string> fixes;
    for (const auto* output : all()) {
      if (!output->fields.contains(field)) continue;
      fixes.push_back(fmt::format("-{} FILE.{}", output->option, output->ending));
    }
    report("quantities", q_.wants(field) && r_.files.holding(field).empty(),
           fmt::format("asks for {} which needs a file", what), "add " + enumerate(fixes, "or"));
  }

  // What -study tau takes from options that fix what it changes.
  void white_noise() {
    refuse({"study"}, to_white_noise_ && r_.scene.noise.name != "ou",
           "takes the -tau of -noise ou to 0, and -noise is " + r_.scene.noise.name,
           "leave it out, or take -noise ou");
    refuse({"noise_deviation"}, to_white_noise_,
           "with -study tau: noise of a fixed deviation has the intensity 2 deviation^2 tau, which "
           "vanishes with tau. White noise of intensity 2 is the limit where the deviation is "
           "1/sqrt(tau)",
           "leave it out; units of time and force give other intensities");
    const auto unfit =
        wanted([](const auto& entry) { return entry.of_one_run || entry.without_limit; });
    report("quantities", to_white_noise_ && !unfit.empty(),
           "asks for " + enumerate(unfit, "and") +
               ", and -study tau follows numbers at arguments that do not depend on the noise",
           "leave that out; averages of functions such as -observable \"abs(v)<=0.5\" have limits");
    const auto& friction = r_.scene.friction;
    const double bias = r_.scene.bias;
    const bool held = bias <= friction.mu_s && -bias <= friction.mu_s_minus.value_or(friction.mu_s);
    const auto of_phases = wanted([](const auto& entry) { return entry.of_phases; });
    report("quantities", to_white_noise_ && !held && !of_phases.empty(),
           fmt::format("asks for {}, about sticking phases: for small tau none begin where the "
                       "bias {:g} exceeds static friction",
                       enumerate(of_phases, "and"), bias),
           "leave that out, or take a larger -mu_s");
  }

  // The words of those asked for that are so.
  template <class Fact>
  [[nodiscard]] std::vector<std::string> wanted(const Fact& fact) const {
    std::vector<std::string> words;
    for (const auto* entry : cases::entries()) {
      if (q_.wants(entry->quantity) && fact(*entry)) words.emplace_back(entry->word);
    }
    return words;
  }

  // What quantities say of themselves.
  void require_own() {
    const bool unbounded = !r_.scene.v_max && !r_.scene.process(1).drag.bounds_velocity();
    for (const auto* entry : cases::entries()) {
      if (!q_.wants(entry->quantity)) continue;
      report("quantities", unbounded && !entry->unbounded.empty(),
             fmt::format("asks for {}, but where drag does not bound the velocity {}", entry->word,
                         entry->unbounded),
             std::string(entry->instead));
    }
  }

  // Numbers for which quantities are wanted.
  void require_arguments() {
    for (const auto* argument : cases::arguments()) {
      const auto words =
          wanted([argument](const auto& entry) { return entry.takes(argument->option); });
      const std::string option(argument->option);
      require(option.c_str(), !argument->optional && !words.empty() && q_.values(option).empty(),
              fmt::format("asks for {}, but no values of -{} are given", enumerate(words, "and"),
                          option),
              fmt::format("add for example -{} {}", option, argument->example));
    }
  }

  void distances() {
    const bool slips = q_.wants(Quantity::slip);
    const bool moves = q_.wants(cases::kDisplacementDistribution.quantity);
    const auto any = [this](const auto& is) { return std::ranges::any_of(q_.distance, is); };
    report("distance", slips && any([](double d) { return d < 0; }),
           "must be positive with slip: paths have no negative lengths",
           "leave negative ones out, or slip");
    report("distance", any([](double d) { return d == 0; }),
           "must not be 0: densities are not defined there",
           "leave 0 out, as an even number of values from -2 to 2 does: -2:2:8");
    require("distance", moves && q_.distance.empty() && q_.values("probability").empty(),
            "asks for displacement_distribution, but neither distances nor probabilities are given",
            "add for example -distance -2:2:40 or -probability 0.05,0.5,0.95");
  }

  // Where no level of the noise holds the body, there are no phases, and the rest exists.
  void require_sticking() {
    if (!settings_.sound() || r_.scene.meant().sticks()) return;
    const auto missing = wanted([](const auto& entry) { return entry.of_phases; });
    std::vector<std::string> without;
    for (const auto* entry : cases::entries()) {
      if (!entry->of_phases) without.emplace_back(entry->word);
    }
    const auto noise = r_.scene.meant().noise;
    const double bias = r_.scene.bias;
    const auto why =
        fmt::format("holds the body on none of the noise levels, from {:g} to {:g}{}: the body "
                    "never sticks, so that there are no phases for ",
                    noise.level(noise.lowest()), noise.level(noise.highest()),
                    bias == 0 ? "" : fmt::format(", shifted by the bias {:g}", bias));
    const std::string finer = noise.table ? "" : ", or a smaller -delta";
    report("mu_s", !missing.empty(), why + enumerate(missing, "and"),
           fmt::format("take -quantities of {}, or a larger -mu_s{}", enumerate(without, "and"),
                       finer));
    report("route", missing.empty() && method_.needs_sticking,
           "follows excursions, which end with a sticking phase; with this -mu_s the body never "
           "sticks",
           "take " + routes_that(&SolutionMethod::needs_sticking, false));
  }

  // "-route excursion or null_vector", of all methods that have a fact in their rows, or lack it.
  [[nodiscard]] static std::string routes_that(bool SolutionMethod::*fact, bool value) {
    std::vector<std::string> words;
    for (const auto& method : cases::solution_methods()) {
      if (method.*fact == value) words.emplace_back(method.word);
    }
    return "-route " + enumerate(words, "or");
  }

  [[nodiscard]] bool asked(std::string_view option) const { return q_.depends_on(option); }

  void warn(Options options, bool when, const std::string& why = "on the quantities asked for") {
    for (const char* option : options) {
      if (!when || !settings_.has(option)) continue;
      r_.warnings.push_back(fmt::format("-{} = {} has no effect {}; leave it out", option,
                                        settings_.text(option), why));
    }
  }

  void refuse(Options options, bool when, const std::string& why, const std::string& fix) {
    for (const char* option : options) report(option, when && settings_.has(option), why, fix);
  }

  // The quantities are refused, unless the option is given: then it may have been misread.
  void require(const char* option, bool when, const std::string& why, const std::string& fix) {
    report("quantities", when && !settings_.has(option), why, fix);
  }

  // Given or not: values may come from the file to compare with.
  void report(const char* option, bool when, const std::string& why, const std::string& fix) {
    if (when) settings_.refuse(option, why, fix);
  }

  Settings& settings_;
  Request& r_;
  const Question& q_;
  const SolutionMethod& method_ = r_.method.row();
  const bool study_ = r_.study.kind != StudyKind::none;
  const bool to_white_noise_ = r_.study.kind == StudyKind::white_noise;
};

}  // namespace

void check_rules(Settings& settings, Request& request) {
  Rules rules(settings, request);
  rules.of_other_effects();
  rules.unused();
  rules.conflicts();
  rules.of_continuous_paths();
  rules.needs();
}

}  // namespace stickslip::cli
