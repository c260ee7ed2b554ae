#include "simulated_results.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "stickslip/catalogue/autocorrelation_keys.hpp"
#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/catalogue/displacement_keys.hpp"
#include "stickslip/catalogue/duration_density_keys.hpp"
#include "stickslip/catalogue/entry_law_keys.hpp"
#include "stickslip/catalogue/expectation_keys.hpp"
#include "stickslip/catalogue/laplace_keys.hpp"
#include "stickslip/catalogue/moments_keys.hpp"
#include "stickslip/catalogue/noise_law_keys.hpp"
#include "stickslip/catalogue/peak_keys.hpp"
#include "stickslip/catalogue/resolvent_keys.hpp"
#include "stickslip/catalogue/slip_keys.hpp"
#include "stickslip/catalogue/spectrum_keys.hpp"
#include "stickslip/catalogue/sticking_keys.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::monte_carlo {
namespace {

using catalogue::Kind;
using catalogue::Quantity;
using catalogue::Row;
using quantities::Result;
using quantities::Results;
using simulation::Duration;
using simulation::Estimate;
using simulation::Integrand;
using simulation::Tally;
using simulation::Variable;

/// Cell of a histogram around one time of -time.
struct Cell {
  double low, high;
};

// Up to halfway between neighbours, and as far on the other side at the ends.
std::vector<Cell> cells_around(const std::vector<double>& time) {
  const std::set<double> sorted(time.begin(), time.end());
  std::vector<Cell> cells;
  for (double t : time) {
    const auto at = sorted.find(t);
    const bool first = at == sorted.begin(), last = std::next(at) == sorted.end();
    const double alone = t > 0 ? 0.05 * t : 1;
    double below = first ? alone : (t - *std::prev(at)) / 2;
    double above = last ? alone : (*std::next(at) - t) / 2;
    if (first && !last) below = above;
    if (last && !first) above = below;
    cells.push_back({std::max(0.0, t - below), t + above});
  }
  return cells;
}

std::vector<double> edges_of(const std::vector<double>& time) {
  std::set<double> edges(time.begin(), time.end());
  for (const Cell& cell : cells_around(time)) edges.insert({cell.low, cell.high});
  return {edges.begin(), edges.end()};
}

void append_value(Result& result, const Estimate& e) {
  result.value.push_back(e.value);
  result.error.push_back(std::max(e.high - e.value, e.value - e.low));
  result.ci95.emplace_back(e.low, e.high);
}

Estimate divided(const Estimate& e, double by) { return {e.value / by, e.low / by, e.high / by}; }

/// Turns a tally into results.
class Estimates {
 public:
  Estimates(const cases::Question& question, const model::Process& process, const Tally& tally)
      : question_(question), process_(process), tally_(tally) {}

  Results all() {
    using enum Quantity;
    const auto wants = [this](Quantity q) { return question_.wants(q); };
    if (wants(sticking)) append_sticking();
    if (wants(moments)) append_moments();
    if (wants(averages)) append_averages();
    if (wants(noise_law)) {
      scalar(catalogue::kPWithin, tally_.stationary(Integrand::inside));
      scalar(catalogue::kEX2, tally_.stationary(Integrand::x_square));
    }
    if (wants(entry_law)) append_hitting_distribution();
    if (wants(laplace)) append_laplace();
    if (wants(stick_duration_transform) && !wants(laplace))
      transform(catalogue::kTransformStick, Duration::stick);
    if (wants(duration_density)) append_durations();
    if (wants(slip)) append_slip();
    if (wants(peak)) append_peak();
    if (wants(spectrum)) append_spectrum();
    if (wants(resolvent)) append_resolvent();
    if (wants(autocorrelation)) {
      over(catalogue::kAutocovariance, question_.time,
           [&](std::size_t n) { return tally_.autocorrelation(n); });
    }
    if (wants(displacement)) append_displacement();
    if (wants(expectation)) append_expectations();
    return std::move(results_);
  }

 private:
  void scalar(const Row& row, const Estimate& e) { scalar(quantities::blank(row), e); }
  void scalar(Result blank, const Estimate& e) {
    append_value(blank, e);
    results_.push_back(std::move(blank));
  }
  // An array of estimate(n) over the n-th abscissa. What no sample met has no size of its own.
  void over(const Row& row, const std::vector<double>& abscissa, const auto& estimate) {
    over(quantities::array(row, abscissa), estimate);
  }
  void over(Result result, const auto& estimate) {
    if (result.kind == Kind::probability || result.kind == Kind::other) {
      result.each_by_its_size = false;
    }
    for (std::size_t n = 0; n < result.abscissa.size(); ++n) append_value(result, estimate(n));
    results_.push_back(std::move(result));
  }

  void append_sticking() {
    scalar(catalogue::kPStick, tally_.share(Duration::stick));
    scalar(catalogue::kPSlide, tally_.share(Duration::slide));
    scalar(catalogue::kMeanStick, tally_.mean(Duration::stick));
    scalar(catalogue::kMeanSlide, tally_.mean(Duration::slide));
    scalar(catalogue::kMeanExcursion, tally_.mean(Duration::excursion));
  }

  void append_moments() {
    scalar(catalogue::kEV2, tally_.stationary(Integrand::v_square));
    scalar(catalogue::kEAbsV, tally_.stationary(Integrand::v_size));
    scalar(catalogue::kEXV, tally_.stationary(Integrand::x_v));
    if (!process_.drifts()) {
      results_.push_back(quantities::scalar(catalogue::kEV, 0, 0));
    } else {
      scalar(catalogue::kEV, tally_.stationary(Integrand::v));
    }
  }

  // Where all samples of f agree they may have missed what is rare: no interval is narrower than
  // that of an event that as many samples miss with probability 0.025. What symmetry makes zero is
  // exactly zero.
  [[nodiscard]] Estimate of_function(const model::Observable& f, Estimate e) const {
    const bool odd = process_.symmetric() && f.least == -f.most;
    if (e.low < e.high || odd || !std::isfinite(f.most - f.least)) return e;
    const double missed = -std::log(0.025) / tally_.samples();
    return {e.value, e.low - missed * (e.value - f.least), e.high + missed * (f.most - e.value)};
  }

  void append_averages() {
    const auto& friction = process_.friction;
    for (std::size_t f = 0; f < question_.observables.size(); ++f) {
      for (const auto& [row, e] : tally_.averages(f)) {
        scalar(quantities::blank(*row, question_.observables[f]),
               row == &catalogue::kPiStick ? e : of_function(question_.observables[f], e));
      }
    }
    scalar(catalogue::kSlipRate, tally_.slip_rate());
    scalar(catalogue::kFrictionPower,
           friction.weakens() ? tally_.averages(question_.observables.size())[0].second
                              : tally_.mean_of_speeds(friction.mu_d, friction.mirrored().mu_d));
  }

  void append_hitting_distribution() {
    const auto& noise = process_.noise;
    const int lowest = process_.lowest_static(), highest = process_.static_index();
    std::vector<double> levels;
    for (int i = lowest; i <= highest; ++i) levels.push_back(i);
    for (std::size_t side = 0; side < (process_.symmetric() ? 1 : 2); ++side) {
      over(side == 0 ? catalogue::kEntryLawPlus : catalogue::kEntryLawMinus, levels,
           [&](std::size_t n) { return tally_.entry(side, static_cast<int>(levels[n])); });
    }
    scalar(catalogue::kFStick0, tally_.first_exit(noise.up_rate(highest), noise.down_rate(lowest)));
  }

  void append_laplace() {
    transform(catalogue::kTransformSlide, Duration::slide);
    transform(catalogue::kTransformStick, Duration::stick);
    transform(catalogue::kTransformExcursion, Duration::excursion);
    scalar(catalogue::kVarSlide, tally_.variance(Duration::slide));
    scalar(catalogue::kVarStick, tally_.variance(Duration::stick));
    scalar(catalogue::kVarExcursion, tally_.variance(Duration::excursion));
  }

  void transform(const Row& row, Duration duration) {
    over(row, question_.lambda, [&](std::size_t n) { return tally_.laplace(n, duration); });
  }

  // Averages over cells, and the distribution function.
  void append_distribution(const Row& density, const Row& distribution, Variable variable,
                           const std::vector<double>& at) {
    const auto cells = cells_around(at);
    over(density, at, [&](std::size_t n) {
      const auto [low, high] = cells[n];
      return divided(tally_.probability(variable, low, high), high - low);
    });
    over(distribution, at, [&](std::size_t n) { return tally_.probability(variable, 0, at[n]); });
  }

  void append_durations() {
    append_distribution(catalogue::kDensitySlide, catalogue::kCdfSlide, Variable::slide,
                        question_.time);
    append_distribution(catalogue::kDensityStick, catalogue::kCdfStick, Variable::stick,
                        question_.time);
    append_distribution(catalogue::kDensityExcursion, catalogue::kCdfExcursion, Variable::excursion,
                        question_.time);
  }

  void append_slip() {
    for (const auto& [row, e] : tally_.slip()) {
      const bool still = row == &catalogue::kMeanSlipNet && !process_.drifts();
      scalar(*row, still ? Estimate{} : e);
    }
    if (!question_.distance.empty()) {
      append_distribution(catalogue::kDensitySlip, catalogue::kCdfSlip, Variable::path,
                          question_.distance);
    }
    if (question_.inverse_distance.empty()) return;
    over(catalogue::kTransformSlip, question_.inverse_distance,
         [&](std::size_t n) { return tally_.slip_transform(n); });
  }

  void append_peak() {
    const auto& w = question_.velocity;
    over(catalogue::kPPeak, w,
         [&](std::size_t n) { return tally_.probability(Variable::peak, w[n], kInfinity); });
    for (std::size_t from : {0, 1}) {
      over(*tally_.first_passage(w[0])[from].first, w,
           [&](std::size_t n) { return tally_.first_passage(w[n])[from].second; });
    }
  }

  void append_spectrum() {
    if (!question_.omega.empty()) {
      over(catalogue::kSV, question_.omega, [&](std::size_t n) { return tally_.spectrum(n); });
    }
    const Estimate s = tally_.spectrum_at_zero();
    scalar(catalogue::kS0, s);
    scalar(catalogue::kDiffusivity, divided(s, 2));
  }

  void append_resolvent() {
    const auto& lambda = question_.lambda;
    const auto exits = tally_.exits(0);
    for (std::size_t which = 0; which < exits.size(); ++which) {
      over(*exits[which].first, lambda,
           [&](std::size_t n) { return tally_.exits(n)[which].second; });
    }
    const double least = *std::min_element(lambda.begin(), lambda.end());
    const std::size_t largest =
        static_cast<std::size_t>(std::max_element(lambda.begin(), lambda.end()) - lambda.begin());
    for (std::size_t f = 0; f < question_.observables.size(); ++f) {
      const auto& observable = question_.observables[f];
      const auto all = tally_.resolvent(largest, f);
      for (std::size_t which = 0; which < all.size(); ++which) {
        const Row& row = *all[which].first;
        if (least == 0 && (&row == &catalogue::kU || &row == &catalogue::kUMinus)) continue;
        over(quantities::array(quantities::blank(row, observable), lambda),
             [&](std::size_t n) { return tally_.resolvent(n, f)[which].second; });
        // Beside averages it may not take their name.
        const bool average = &row == &catalogue::kPiLambda;
        if (average && !question_.wants(Quantity::averages)) {
          results_.back().key = catalogue::kPi.key_of(observable.name);
        }
      }
    }
  }

  void append_displacement() {
    const bool still = !process_.drifts() && question_.start.kind != model::Start::Kind::state;
    over(catalogue::kDisplacementMean, question_.time,
         [&](std::size_t n) { return still ? Estimate{} : tally_.travel(n)[0].second; });
    over(catalogue::kDisplacementVariance, question_.time,
         [&](std::size_t n) { return tally_.travel(n)[1].second; });
  }

  void append_expectations() {
    for (std::size_t f = 0; f < question_.observables.size(); ++f) {
      const auto& observable = question_.observables[f];
      over(quantities::array(quantities::blank(catalogue::kExpectationOf, observable),
                             question_.time),
           [&](std::size_t n) { return of_function(observable, tally_.expectation(f, n)); });
      scalar(quantities::blank(catalogue::kStationaryOf, observable),
             of_function(observable, tally_.averages(f)[0].second));
    }
  }

  const cases::Question& question_;
  const model::Process& process_;
  const Tally& tally_;
  Results results_;
};

}  // namespace

simulation::Wanted wanted_of(const cases::Question& question, const model::Process& process) {
  const auto wants = [&](Quantity q) { return question.wants(q); };
  simulation::Wanted wanted;
  wanted.moments = wants(Quantity::moments) || wants(Quantity::averages);
  wanted.noise = wants(Quantity::noise_law);
  wanted.displacement = wants(Quantity::spectrum) || wants(Quantity::slip);
  if (wants(Quantity::spectrum)) wanted.omega = question.omega;
  if (wants(Quantity::laplace) || wants(Quantity::stick_duration_transform)) {
    wanted.lambda = question.lambda;
  }
  if (wants(Quantity::averages) || wants(Quantity::resolvent) || wants(Quantity::expectation)) {
    wanted.observables = question.observables;
  }
  if (wants(Quantity::averages) && process.friction.weakens()) {  // after all that are asked for
    wanted.observables.push_back(model::friction_power(process.friction));
  }
  if (wants(Quantity::resolvent)) wanted.discount = question.lambda;
  wanted.expectation = wants(Quantity::expectation);
  wanted.travel = wants(Quantity::displacement);
  if (wanted.expectation || wanted.travel) wanted.start = question.start;
  wanted.autocorrelation = wants(Quantity::autocorrelation);
  if (wanted.start || wanted.autocorrelation) wanted.time = question.time;
  if (wants(Quantity::duration_density)) wanted.edges = edges_of(question.time);
  if (wants(Quantity::slip)) wanted.path_edges = edges_of(question.distance);
  if (wants(Quantity::slip)) wanted.inverse_distance = question.inverse_distance;
  if (wants(Quantity::peak)) wanted.speeds = question.velocity;
  std::sort(wanted.speeds.begin(), wanted.speeds.end());
  return wanted;
}

Results estimates(const cases::Question& question, const model::Process& process,
                  const Tally& tally) {
  Results all = Estimates(question, process, tally).all();
  quantities::leave_out_missing_side(process, all);
  return all;
}

}  // namespace stickslip::monte_carlo
