#include "stickslip/run/refine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <set>
#include <utility>

#include "stickslip/base/errors.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/run/carry_out.hpp"

namespace stickslip::run {
namespace {

using cases::Quantity;
using quantities::Results;
using quantities::StationaryDistribution;

// Errors of hp functionals fall about tenfold a degree, more at low degrees than at high ones. Each
// change is the error one degree lower, unless that vanishes by accident; the two together rarely
// do. For each degree, at low degrees for this one; see validation/calibration.
// Where no element follows waves of a spectrum, they come and go with the degree.
constexpr ErrorPerChange kHpErrorPerChange{
    .last = 0.07, .earlier = 0.0035, .alone = 2.2, .of_waves = 1.5, .most_fall = 16};
constexpr int kLeastDegreeOfErrors = 10;
// Under the levels of a table errors fall in uneven steps, of which the change before tells more,
// and the other family of means: all changes of one are small at once now and then.
constexpr double kEarlierOfTables = 4, kOtherFamilyOfTables = 0.6;
// Of projections modes are added. Errors may fall by a ratio, or stand still where no element
// changes that counts, and then the change before tells more.
constexpr double kLastOfProjections = 2.5, kEarlierOfProjections = 4;
// Of levels with positions functions jump along curves, and errors fall slowly.
constexpr double kLastOfCurves = 4;
// Where elements move from level to level changes tell less.
constexpr double kOnOtherElements = 1.4;
// Where friction weakens errors fall as they otherwise do so many degrees higher.
constexpr int kDegreesOfWeakening = 4;
constexpr int kLowestDegree = 5, kHighestDegree = 19;
constexpr int kDegreesLessInNoise = 1;
constexpr double kModesOnNodes = 1e-7;  // the least accuracy

// First-order differences: the change from p/2 to p is the error at p up to what the order differs
// from 1 (0.86 to 1.01 was seen for p >= 64; a few points are far from any order).
double order_margin(int points) { return 1.5 * (1 + 2.0 / points); }
constexpr int kFirstPoints = 8;

// Degree at which the estimate, the error one degree below, is expected to meet the accuracy.
// Errors are about 10^-d at degree d; those of displacements tenfold smaller, those of the density
// of sticking times at 0+ tenfold larger, of densities of durations and of spectra where there are
// waves a hundredfold. (On coarser elements reduced models search long for waves that are not
// resolved.) The catalogue has the numbers. On the elements for path lengths a degree is worth one
// digit and a half, but to the densities of these it is worth less than one.
int starting_degree(const cases::Question& question, bool waves, bool lengths) {
  const double digits = -std::log10(question.accuracy);
  double highest = waves ? digits + 3 : 0;
  for (const auto* entry : cases::entries()) {
    if (!question.wants(entry->quantity)) continue;
    highest = std::max(highest, digits + entry->degrees_besides);
  }
  if (lengths) highest = std::max(highest / 1.5, 1.2 * digits + 1.2);
  return std::clamp(static_cast<int>(std::ceil(highest)), kLowestDegree, kHighestDegree);
}

// Observables on the levels on which they were looked at, once each whatever is done with them.
generator::Integrands integrands_of(const cases::Question& question, double phase) {
  generator::Integrands integrands;
  if (phase > 0) {
    integrands.functions.emplace_back([phase](double v) { return std::cos(phase * v); });
  }
  for (const auto& observable : question.observables) {
    const auto f = std::make_shared<const model::Observable>(observable);
    integrands.breaks.insert(integrands.breaks.end(), f->breaks.begin(), f->breaks.end());
    model::merge(integrands.places, f->places);
    for (const auto& x : f->levels) {
      for (double sign : {1.0, -1.0}) {
        integrands.functions.emplace_back(model::section(f, x, sign));
      }
    }
  }
  return integrands;
}

std::string gigabytes(double bytes) { return fmt::format("{:.2g} GB", bytes / 1e9); }

Solved evaluated(MPI_Comm comm, const cases::Case& given, const Resolution& resolution,
                 const std::shared_ptr<quantities::Recipes>& recipes) {
  Solved solved;
  Step& step = solved.step;
  step.resolution = resolution;
  const double start = linalg::wall_seconds();
  Problem problem{comm, given, discretise(given.scene, resolution), step.statistics, recipes};
  for (double omega : resolution.waves) {
    problem.waves.emplace(omega, discretise(given.scene, following(resolution, omega)));
  }
  solved.evaluation = evaluate(problem);
  quantities::leave_out_missing_side(problem.discretisation.process, solved.evaluation.results);
  quantities::leave_out_uncountable(problem.discretisation.process, solved.evaluation.results);
  // Of nodes tied together where bodies start, see GaussianNoise::projected().
  const double tied = problem.discretisation.process.noise.continuous() ? 2e-7 : 0;
  const double rounding = tied + model::rounding_of_sums(problem.discretisation.process.noise);
  require_least_error(rounding + resolution.truncation, solved.evaluation.results);
  step.checks = std::move(solved.evaluation.checks);
  step.seconds = linalg::wall_seconds() - start;
  return solved;
}

// What has no digit after so many will have none, as modes in a continuous spectrum have not.
constexpr double kOneDigit = 0.1;
constexpr int kRefinementsWithoutDigit = 6;
// The loosest accuracy that is advised.
constexpr double kLoosest = 0.05;
// Below as many unknowns a step takes hardly longer than to predict how long.
constexpr std::int64_t kWorthPrediction = 30'000;

class Refiner {
 public:
  Refiner(MPI_Comm comm, const cases::Case& given, const Progress& progress)
      : comm_(comm),
        given_(given),
        question_(given.question),
        progress_(progress),
        sequence_(given),
        left_(given) {}

  Outcome run() {
    refine();
    append_failed();
    if (question_.wants(Quantity::density))
      outcome_.density = quantities::density_field(*distribution_);
    return std::move(outcome_);
  }

 private:
  struct Limit {
    double last = kInfinity;  // rounding of the refinement level before
    int in_vain = 0;          // refinements
    int without_digit = 0;    // refinements in a row
  };

  void refine() {
    require_start_within(given_, sequence_.refinement_level(sequence_.first()));
    require_memory(comm_, given_.scene, sequence_.refinement_level(1));
    for (int n = sequence_.first(); n <= sequence_.last(); ++n) {
      if (n >= 2 && !fits(sequence_.refinement_level(n))) return short_of_memory(n);
      solve(n);
      if (n < 1) continue;
      if (finished()) {
        if (outcome_.reached) outcome_.next_digit_seconds = next_digit(n);
        return;
      }
      if (sequence_.first_order() && hopeless(n)) return;
    }
    outcome_.shortfall = !limit_.empty() ? limit_
                         : given_.method.fixed()
                             ? "-degree, -layers or -p fixes the discretisation; leave them out to "
                               "have it refined"
                             : "the refinement sequence ends here";
  }

  [[nodiscard]] bool fits(const Resolution& resolution) const {
    const double need = predicted_bytes(given_.scene, resolution, linalg::ranks(comm_));
    return need <= linalg::available_bytes(comm_, need);
  }

  void solve(int n) {
    Resolution resolution = sequence_.refinement_level(n);
    leave_out_settled(resolution.waves);
    const int step_number = static_cast<int>(outcome_.steps.size());
    if (progress_) progress_(step_number, resolution, expected_seconds(resolution));
    auto [evaluation, step] = evaluated(comm_, left_, resolution, recipes_);
    leave_out_failed(n, evaluation);
    remember_rounding(evaluation.results);
    if (!outcome_.steps.empty()) add_discretisation(n, evaluation.results);
    keep_more_accurate(evaluation.results);
    outcome_.results = std::move(evaluation.results);
    outcome_.modes = std::move(evaluation.modes);
    follow(std::move(evaluation.distribution));
    outcome_.total += step.statistics;
    outcome_.steps.push_back(std::move(step));
  }

  // A quantity that fails is asked for no longer. Its values are those of the step before where
  // these have error estimates, and else not known.
  void leave_out_failed(int n, const Evaluation& evaluation) {
    if (evaluation.failed.empty()) return;
    const bool estimated = n >= 2;
    for (const auto& [quantity, reason] : evaluation.failed) {
      const auto& entries = cases::entries();
      const auto* entry = *std::ranges::find(entries, quantity, &cases::Entry::quantity);
      left_.question.quantities.erase(quantity);
      outcome_.failures +=
          fmt::format("{}{}: {}", outcome_.failures.empty() ? "" : "; ", entry->word, reason);
      if (estimated) continue;
      for (auto& result : quantities::without_values(given_, quantity, reason)) {
        failed_.push_back(std::move(result));
      }
    }
    Results before = std::exchange(outcome_.results, {});
    Changes changes = std::exchange(changes_, {});
    for (std::size_t r = 0; r < before.size(); ++r) {
      const auto& now = evaluation.results;
      const bool goes_on =
          std::ranges::find(now, before[r].key, &quantities::Result::key) != now.end();
      if (goes_on && r < changes.size()) changes_.push_back(std::move(changes[r]));
      if (goes_on || estimated) {
        (goes_on ? outcome_.results : failed_).push_back(std::move(before[r]));
      }
    }
    const bool nothing = std::ranges::none_of(failed_, quantities::all_numbers);
    if (evaluation.results.empty() && nothing) throw NotReached(outcome_.failures);
  }

  void append_failed() {
    if (outcome_.failures.empty()) return;
    outcome_.reached = false;
    outcome_.shortfall += (outcome_.shortfall.empty() ? "" : "; ") + outcome_.failures;
    for (auto& result : failed_) outcome_.results.push_back(std::move(result));
  }

  // Waves are followed only where a frequency misses the accuracy without, and from then on.
  void leave_out_settled(std::vector<double>& waves) const {
    if (outcome_.steps.empty()) return;
    const auto& followed = outcome_.steps.back().resolution.waves;
    const auto settled = [&](double omega) {
      if (std::count(followed.begin(), followed.end(), omega) > 0) return false;
      return std::all_of(
          outcome_.results.begin(), outcome_.results.end(),
          [&](const quantities::Result& spectrum) {
            if (spectrum.kind != quantities::Kind::spectrum || spectrum.is_scalar()) return true;
            const auto& omegas = spectrum.abscissa;
            const auto at = std::find(omegas.begin(), omegas.end(), omega) - omegas.begin();
            return spectrum.error[at] <= question_.accuracy * std::abs(spectrum.value[at]);
          });
    };
    waves.erase(std::remove_if(waves.begin(), waves.end(), settled), waves.end());
  }

  [[nodiscard]] double expected_seconds(const Resolution& next) const {
    if (outcome_.steps.empty()) {
      if (unknowns(given_.scene, next) < kWorthPrediction) return 0;
      return predicted_step(comm_, given_, quantities::plan_of(given_), next).seconds;
    }
    const Step& last = outcome_.steps.back();
    return last.seconds * relative_work(given_.scene, next) /
           relative_work(given_.scene, last.resolution);
  }

  // The errors of the solution method itself, for the verdict.
  void remember_rounding(const Results& results) {
    rounding_.clear();
    for (const auto& result : results) rounding_.push_back(quantities::relative_error(result));
  }

  void add_discretisation(int n, Results& results) {
    changes_ =
        run::add_discretisation(sequence_.error_per_change(n), outcome_.results, changes_, results);
  }

  // Where rounding grows with the degree, an earlier step was better by far. By less than that,
  // estimates differ by chance, and the least of them would be too small.
  void keep_more_accurate(Results& results) const {
    constexpr double mostly = 2, far = 30;
    constexpr std::size_t without_estimate = 2;
    if (outcome_.steps.size() <= without_estimate) return;
    for (std::size_t r = 0; r < results.size(); ++r) {
      const auto& before = outcome_.results[r];
      const double error = quantities::relative_error(results[r]);
      const bool rounded = rounding_[r] > question_.accuracy && rounding_[r] > error / mostly;
      if (rounded && error > far * quantities::relative_error(before)) results[r] = before;
    }
  }

  // A density and a truncation velocity given by hand need the distribution of |V|. How far its
  // distribution function moved is the density's own measure. It converges slowly (the density has
  // corners), so the whole change is taken for the error.
  void follow(std::shared_ptr<const StationaryDistribution> distribution) {
    if (!distribution || (!question_.wants(Quantity::density) && !given_.scene.v_max)) return;
    auto now = quantities::speed_distribution(*distribution);
    if (speed_) outcome_.speed_error = quantities::distance(*speed_, now);
    speed_ = std::move(now);
    distribution_ = std::move(distribution);
  }

  // The largest relative error of a step, of results that are not given up; its rounding.
  double judge(Step& step) const {
    double rounding = 0;
    step.estimate = 0;
    for (std::size_t r = 0; r < outcome_.results.size(); ++r) {
      const auto& result = outcome_.results[r];
      const double error = quantities::relative_error(result);
      if (result.diagnostic || given_up_.contains(result.key) || error <= step.estimate) continue;
      step.estimate = error;
      step.limiting_key = result.key;
      rounding = rounding_[r];
    }
    return rounding;
  }

  // What rounding limits is given up, and the others are refined on.
  [[nodiscard]] bool finished() {
    Step& step = outcome_.steps.back();
    const Step& before = outcome_.steps[outcome_.steps.size() - 2];
    // One that only now resolves waves has nothing to be compared with.
    count_refinements_in_vain(step.resolution.waves.size() > before.resolution.waves.size());
    // What reduced models miss on coarse grids, and what sums over nodes overlook of an
    // observable, falls unevenly.
    const int refinements = question_.observables.empty() ? 2 : 3;
    for (;;) {
      const double rounding = judge(step);
      if (step.estimate <= question_.accuracy) {
        conclude(step);
        return true;
      }
      const Limit& limit = limits_[step.limiting_key];
      const int patience = limiting(step).limited_by.empty() ? refinements : 1;
      if (limit.in_vain < patience && limit.without_digit < kRefinementsWithoutDigit) return false;
      give_up(step, rounding);
    }
  }

  // What a finer discretisation still improves is no limit yet.
  void count_refinements_in_vain(bool anew) {
    for (std::size_t r = 0; r < outcome_.results.size(); ++r) {
      Limit& limit = limits_[outcome_.results[r].key];
      if (anew) limit = {.in_vain = limit.in_vain};
      const bool falls = rounding_[r] < 0.5 * std::exchange(limit.last, rounding_[r]);
      // Where a value has no error estimate yet, finer discretisations may reach further.
      const bool out_of_reach =
          std::isinf(rounding_[r]) && quantities::all_numbers(outcome_.results[r]);
      if (!(rounding_[r] <= question_.accuracy || falls || out_of_reach)) ++limit.in_vain;
      ++limit.without_digit;
      if (quantities::relative_error(outcome_.results[r]) <= kOneDigit) limit.without_digit = 0;
    }
  }

  [[nodiscard]] const quantities::Result& limiting(const Step& step) const {
    return *std::ranges::find(outcome_.results, step.limiting_key, &quantities::Result::key);
  }

  // Who sets a solver by hand looks there first.
  [[nodiscard]] static std::string no_digit() {
    std::string doubted;
    for (const auto& [name, value] : linalg::given_solver_options()) {
      doubted += fmt::format("{}-{} {}", doubted.empty() ? "" : ", ", name, value);
    }
    return doubted.empty()
               ? "; no digit of it is certain: leave it out"
               : fmt::format("; no digit of it is certain, with {}: leave that out", doubted);
  }

  void give_up(const Step& step, double rounding) {
    const std::string& key = step.limiting_key;
    const auto& result = limiting(step);
    const double least = std::max(rounding, step.estimate);
    if (2 * least > outcome_.attainable) {
      outcome_.attainable = 2 * least;
      limit_ =
          fmt::format("{} the relative error of {}{} to {:.1e}{}", what_limits(result), key,
                      quantities::where_unknown(result), least, least < kLoosest ? "" : no_digit());
    }
    given_up_.insert(key);
    if (!over_modes(result)) return;
    // Rates and frequencies are of the same modes.
    for (const auto& r : outcome_.results) {
      if (over_modes(r)) given_up_.insert(r.key);
    }
  }

  void conclude(Step& step) {
    outcome_.reached = given_up_.empty();
    outcome_.shortfall = limit_;
    for (auto& r : outcome_.results) {
      if (over_modes(r) && given_up_.contains(r.key)) doubt_without_digit(kOneDigit, r);
    }
    check_truncation();
    check_unreached();
    check_bounds();
    given_up_.clear();
    (void)judge(step);  // for the table, of all
  }

  // Entries without a value leave the others as they are.
  void check_unreached() {
    for (const auto& result : outcome_.results) {
      for (std::size_t n = 0; n < result.value.size(); ++n) {
        if (!quantities::is_unreached(result, n)) continue;
        outcome_.reached = false;
        outcome_.shortfall +=
            fmt::format("{}{}{} {}", outcome_.shortfall.empty() ? "" : "; ", result.key,
                        quantities::place(result, n), result.unreached);
        return;
      }
    }
  }

  [[nodiscard]] std::string what_limits(const quantities::Result& result) {
    if (!result.limited_by.empty()) return result.limited_by;
    if (limits_[result.key].without_digit > 0) return "what refinement cannot resolve limits";
    if (given_.scene.v_max && !given_.scene.limits_speed) return "-v_max, or rounding, limits";
    if (given_.method.row().small_lambda) return "lambda > 0 or rounding limits";
    if (question_.observables.empty()) return "rounding limits";
    return "rounding, or an observable too steep for the elements, limits";
  }

  // Time of the run that would find one digit more, from how fast estimates fell.
  [[nodiscard]] double next_digit(int n) const {
    const auto& steps = outcome_.steps;
    double fall = 1;  // digits a step
    const double before = steps[steps.size() - 2].estimate, now = steps.back().estimate;
    if (before > 0 && now > 0) fall = std::log10(before / now);
    if (sequence_.first_order()) fall = std::log10(2.0);
    const int more = static_cast<int>(std::ceil(1 / std::clamp(fall, 0.2, 10.0)));
    if (n + more > sequence_.last() || 0.1 * question_.accuracy < 1e-14) return 0;
    double seconds = 0;
    for (const Step& step : steps) seconds += step.seconds;
    const auto work = [this](int refinement_level) {
      return relative_work(given_.scene, sequence_.refinement_level(refinement_level));
    };
    return seconds * work(n + more) / work(n);
  }

  // A truncation velocity given by hand is no part of the model: the mass beyond it is an error.
  void check_truncation() {
    if (!given_.scene.v_max || given_.scene.limits_speed || !speed_) return;
    const double held = speed_->at_top, sliding = 1 - speed_->at_rest;
    if (held <= question_.accuracy * sliding) return;
    outcome_.reached = false;
    outcome_.shortfall = fmt::format(
        "-v_max = {:g} excludes {:.1e} of the sliding time; leave it out, or take it larger",
        *given_.scene.v_max, held / sliding);
  }

  // Results outside their bounds show that errors are too small.
  void check_bounds() {
    const std::string broken = broken_bound(outcome_.results);
    if (broken.empty()) return;
    const int levels = outcome_.steps.back().resolution.levels;
    outcome_.reached = false;
    outcome_.shortfall = broken + model::please_report(given_.scene.process(levels));
  }

  // A first-order scheme shows early how many points it would take.
  [[nodiscard]] bool hopeless(int n) {
    const Resolution now = sequence_.refinement_level(n);
    const double needed = now.points * outcome_.steps.back().estimate / question_.accuracy;
    if (n < 3 || given_.method.fixed()) return false;
    Resolution final = now;
    final.points = static_cast<int>(std::min(needed, 1e9));
    if (fits(final)) return false;
    outcome_.shortfall = fmt::format(
        "the upwind scheme would need about p = {:.1e} and {} of memory; take -scheme hp, or "
        "-accuracy {:.0e}",
        needed, gigabytes(predicted_bytes(given_.scene, final)),
        2 * outcome_.steps.back().estimate);
    return true;
  }

  void short_of_memory(int n) {
    outcome_.shortfall =
        fmt::format("the next refinement would need {} of memory",
                    gigabytes(predicted_bytes(given_.scene, sequence_.refinement_level(n))));
  }

  MPI_Comm comm_;
  const cases::Case& given_;
  const cases::Question& question_;
  const Progress& progress_;
  RefinementSequence sequence_;
  cases::Case left_;  // without what has failed
  Results failed_;    // what is known of that
  Outcome outcome_;
  std::vector<double> rounding_;         // relative, of each result
  std::map<std::string, Limit> limits_;  // by key of results
  std::set<std::string> given_up_;       // keys of results that stay inaccurate
  std::string limit_;                    // what limits the worst of them
  Changes changes_;                      // of the last step
  std::shared_ptr<quantities::Recipes> recipes_ = std::make_shared<quantities::Recipes>();
  std::shared_ptr<const StationaryDistribution> distribution_;  // of the last step, if needed
  std::optional<quantities::SpeedDistribution> speed_;
};

}  // namespace

RefinementSequence::RefinementSequence(const cases::Case& given)
    : scene_(given.scene),
      method_(given.method),
      accuracy_(given.question.accuracy),
      needs_(quantities::plan_of(given).needs) {
  const auto process = given.scene.meant();
  std::ranges::copy_if(needs_.omega, std::back_inserter(waves_),
                       [&](double omega) { return generator::has_waves(process, omega); });
  first_degree_ = method_.degree.value_or(
      starting_degree(given.question, !waves_.empty(), needs_.rates.lengths));
  table_ = process.noise.table != nullptr;
  integrands_ = integrands_of(given.question, needs_.phase);
  const bool full_grid = given.method.row().full_grid;
  const bool both = given.question.any(&cases::Entry::both_branches);
  branches_ = full_grid || both || !given.scene.symmetric() ? 2 : 1;
  // On nodes the residuals of eigenvectors, which stand for errors, stay about twice as large.
  const bool near_rounding = needs_.modes && accuracy_ < kModesOnNodes;
  // Groups are wide at noises that are rare. Weights exp(s x(t)) move the noise by 2 s D, against
  // its deviation (D/tau)^1/2.
  constexpr double most_moved = 2;
  const auto& noise = process.noise;
  const double moved =
      2 * needs_.rates.tilt * std::sqrt(noise.intensity() * noise.correlation_time());
  all_levels_ = full_grid || method_.noise_degree == 0 || near_rounding ||
                (!method_.noise_degree && moved > most_moved) || !noise.neighbours_only();
  tail_counts_ =
      !given.question.observables.empty() || given.question.any(&cases::Entry::weighs_tail);
  last_ = method_.fixed() ? 1 : free_refinement_levels();
  if (const auto* projector = scene_.projector()) {
    while (last_ > 1 && !projector->fits(scene_.thresholds(), degree(last_))) --last_;
  }
}

int RefinementSequence::free_refinement_levels() const {
  switch (method_.scheme) {
  case cases::Scheme::hp: return 1 + kHighestDegree - first_degree_;
  case cases::Scheme::upwind: return 20;
  case cases::Scheme::none: return 3;
  }
  return 1;
}

int RefinementSequence::first() const {
  return method_.scheme == cases::Scheme::hp && first_degree_ > 1 ? -1 : 0;
}

int RefinementSequence::degree(int n) const { return std::max(0, first_degree_ + n - 1); }

int RefinementSequence::points(int n) const {
  if (!method_.points) return kFirstPoints << n;
  if (n == 1) return *method_.points;
  return *method_.points == 1 ? 2 : (*method_.points + 1) / 2;
}

double RefinementSequence::tail_tolerance(int n) const {
  if (method_.scheme == cases::Scheme::upwind) return 1e-3 * std::min(accuracy_, 1e-6);
  if (method_.scheme == cases::Scheme::none) return std::max(accuracy_ * std::pow(1e-2, n), 1e-18);
  // The first level reaches as far as the second where later ones reach further: where a body may
  // start does not depend on what is only compared with.
  const double tolerance = std::pow(10.0, -(degree(tail_counts_ ? std::max(n, 0) : 1) + 4));
  // Modes have a mean square under the density: what its root is at the end is an error.
  return needs_.modes ? std::max(tolerance * tolerance, 1e-36) : std::max(tolerance, 1e-18);
}

generator::Grouping RefinementSequence::grouping(int n) const {
  generator::Grouping grouping;
  if (all_levels_) return grouping;
  grouping.grading = method_.noise_grading;
  // Never the same on two refinement levels, or no change would show the error.
  constexpr int least = 2;
  grouping.degree = method_.noise_degree ? std::max(0, *method_.noise_degree + n - 1)
                                         : std::max(least + n, degree(n) - kDegreesLessInNoise);
  return grouping;
}

// Elements follow waves where the first estimate asks for it: in most cases the noise damps them.
// Levels of a table may not, and then changes between coarse discretisations say nothing.
std::vector<double> RefinementSequence::waves(int n) const {
  constexpr int first_with_waves = 2;
  const bool follows = n >= first_with_waves || method_.fixed() || table_;
  return follows ? waves_ : std::vector<double>{};
}

const Resolution& RefinementSequence::refinement_level(int n) const {
  const auto known = refinement_levels_.find(n);
  return known != refinement_levels_.end() ? known->second
                                           : refinement_levels_.emplace(n, made(n)).first->second;
}

Resolution RefinementSequence::made(int n) const {
  Resolution r;
  switch (method_.scheme) {
  case cases::Scheme::hp:
    r = hp_resolution(scene_, degree(n), method_.layers.value_or(0), tail_tolerance(n),
                      needs_.rates, grouping(n));
    r.waves = waves(n);
    r.integrands = integrands_;
    r.whole_tail = tail_counts_;
    r.least_degree = n + 1;  // so that all degrees rise from one refinement level to the next
    break;
  case cases::Scheme::upwind:
    r = upwind_resolution(scene_, points(n), tail_tolerance(n), needs_.rates);
    break;
  case cases::Scheme::none: r = exact_resolution(scene_, tail_tolerance(n)); break;
  }
  r.branches = branches_;
  r.factors = method_.factors;
  return r;
}

ErrorPerChange RefinementSequence::error_per_change(int n) const {
  switch (method_.scheme) {
  case cases::Scheme::hp: {
    const int weakening = scene_.friction.stribeck ? kDegreesOfWeakening : 0;
    const double moving = tail_counts_ ? kOnOtherElements : 1;
    const double degrees = moving * std::max(kLeastDegreeOfErrors, degree(n) + weakening);
    ErrorPerChange factor = kHpErrorPerChange;
    factor.last *= degrees;
    factor.earlier *= degrees;
    if (!waves_.empty()) factor.waves_from = std::ranges::min(waves_);
    if (scene_.projector()) {
      factor.last *= scene_.spring && !scene_.noise.gaussian ? kLastOfCurves : kLastOfProjections;
      factor.earlier *= kEarlierOfProjections;
      factor.most_fall = kInfinity;
    } else if (table_) {
      factor.earlier *= kEarlierOfTables;
      factor.of_other_family = kOtherFamilyOfTables;
    }
    return factor;
  }
  case cases::Scheme::upwind: {
    const double ratio = static_cast<double>(points(n)) / points(n - 1);
    return {order_margin(points(n)) / std::abs(ratio - 1), 0};
  }
  case cases::Scheme::none: return {1, 0};
  }
  return {};
}

std::string shortfall_of_memory(MPI_Comm comm, const model::Scene& scene,
                                const Resolution& resolution) {
  const double need = predicted_bytes(scene, resolution, linalg::ranks(comm));
  const double have = linalg::available_bytes(comm, need);
  if (need <= have) return "";
  return fmt::format(
      "about {:.3g} unknowns would need {} of memory, and {} are free; take a larger -delta, a "
      "looser -accuracy, fewer -noise_levels or more machines",
      static_cast<double>(unknowns(scene, resolution)), gigabytes(need), gigabytes(have));
}

void require_memory(MPI_Comm comm, const model::Scene& scene, const Resolution& resolution) {
  const std::string shortfall = shortfall_of_memory(comm, scene, resolution);
  if (!shortfall.empty()) throw NoMemory(shortfall);
}

Solved solve_on(MPI_Comm comm, const cases::Case& given, const Resolution& resolution) {
  require_memory(comm, given.scene, resolution);
  return evaluated(comm, given, resolution, std::make_shared<quantities::Recipes>());
}

Outcome refine(MPI_Comm comm, const cases::Case& given, const Progress& progress) {
  return Refiner(comm, given, progress).run();
}

std::string tried_accuracy(MPI_Comm comm, const cases::Case& given, const Outcome& outcome) {
  cases::Case looser = given;
  for (double next = outcome.attainable; next > 0 && next < 2 * kLoosest;) {
    const std::string text = fmt::format("{:.0e}", next);
    looser.question.accuracy = std::stod(text);
    const Outcome tried = Refiner(comm, looser, {}).run();
    const char* other = given.method.row().small_lambda ? "another -lambda or " : "";
    if (tried.reached) return fmt::format("; take {}-accuracy {}", other, text);
    next = std::max(10 * next, tried.attainable);
  }
  return outcome.attainable > 0 && outcome.attainable < 2 * kLoosest
             ? "; a looser -accuracy does not help: leave it out"
             : "";
}

}  // namespace stickslip::run
