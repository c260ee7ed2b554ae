#include "stickslip/accuracy/refinement_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "stickslip/quantities/plan.hpp"

namespace stickslip::accuracy {
namespace {

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
  for (const auto* entry : catalogue::entries()) {
    if (!question.wants(entry->quantity)) continue;
    highest = std::max(highest, digits + entry->degrees_besides);
  }
  if (lengths) highest = std::max(highest / 1.5, 1.2 * digits + 1.2);
  return std::clamp(static_cast<int>(std::ceil(highest)), kLowestDegree, kHighestDegree);
}

// Observables on the levels on which they were looked at, once each whatever is done with them.
velocity::Integrands integrands_of(const cases::Question& question, double phase) {
  velocity::Integrands integrands;
  if (phase > 0) {
    integrands.functions.emplace_back([phase](double v) { return std::cos(phase * v); });
  }
  for (const auto& observable : question.observables) {
    const auto f = std::make_shared<const model::Observable>(observable);
    integrands.breaks.insert(integrands.breaks.end(), f->breaks.begin(), f->breaks.end());
    model::merge(integrands.places, f->places);
    for (double x : f->levels) {
      for (double sign : {1.0, -1.0}) {
        integrands.functions.emplace_back(model::section(f, x, sign));
      }
    }
  }
  return integrands;
}

}  // namespace

RefinementSequence::RefinementSequence(const cases::Case& given)
    : scene_(given.scene),
      method_(given.method),
      accuracy_(given.question.accuracy),
      needs_(quantities::plan_of(given).needs) {
  const auto process = given.scene.meant();
  std::ranges::copy_if(needs_.omega, std::back_inserter(waves_),
                       [&](double omega) { return velocity::has_waves(process, omega); });
  first_degree_ = method_.degree.value_or(
      starting_degree(given.question, !waves_.empty(), needs_.rates.lengths));
  table_ = process.noise.table != nullptr;
  integrands_ = integrands_of(given.question, needs_.phase);
  const bool full_grid = given.method.row().full_grid;
  const bool both = given.question.any(&catalogue::Entry::both_branches);
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
      !given.question.observables.empty() || given.question.any(&catalogue::Entry::weighs_tail);
  last_ = method_.fixed() ? 1 : free_refinement_levels();
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

noise::Grouping RefinementSequence::grouping(int n) const {
  noise::Grouping grouping;
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
    if (table_) {
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

}  // namespace stickslip::accuracy
