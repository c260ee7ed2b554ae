#include "simulated_results.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "stickslip/quantities/excursion.hpp"

namespace stickslip::monte_carlo {
namespace {

using options::Quantity;
using quantities::Kind;
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
  Estimates(const options::Question& question, const model::Process& process, const Tally& tally)
      : question_(question), process_(process), tally_(tally) {}

  Results all() {
    using enum Quantity;
    const auto wants = [this](Quantity q) { return question_.wants(q); };
    if (wants(sticking)) append_sticking();
    if (wants(moments)) append_moments();
    if (wants(averages)) append_averages();
    if (wants(noise_law)) {
      scalar(quantities::kPWithin, tally_.stationary(Integrand::inside));
      scalar(quantities::kEX2, tally_.stationary(Integrand::x_square));
    }
    if (wants(entry_law)) append_hitting_distribution();
    if (wants(laplace)) append_laplace();
    if (wants(stick_duration_transform) && !wants(laplace)) transform("F_stick", Duration::stick);
    if (wants(duration_density)) append_durations();
    if (wants(slip)) append_slip();
    if (wants(peak)) append_peak();
    if (wants(spectrum)) append_spectrum();
    if (wants(resolvent)) append_resolvent();
    if (wants(autocorrelation)) {
      over("C_vv", Kind::other, question_.time,
           [&](std::size_t n) { return tally_.autocorrelation(n); });
    }
    if (wants(displacement)) append_displacement();
    if (wants(expectation)) append_expectations();
    return std::move(results_);
  }

 private:
  void scalar(const quantities::Name& name, const Estimate& e) { scalar(name.key, name.kind, e); }
  void scalar(const std::string& key, Kind kind, const Estimate& e) {
    Result result{key, options::unit_of(key), "", {}, {}, {}, kind};
    append_value(result, e);
    results_.push_back(std::move(result));
  }
  // An array of estimate(n) over the n-th abscissa.
  template <class Estimates>
  void over(const std::string& key, Kind kind, const std::vector<double>& abscissa,
            const Estimates& estimate) {
    Result result = quantities::array(key, abscissa, kind);
    for (std::size_t n = 0; n < abscissa.size(); ++n) append_value(result, estimate(n));
    results_.push_back(std::move(result));
  }

  void append_sticking() {
    scalar(quantities::kPStick, tally_.share(Duration::stick));
    scalar(quantities::kPSlide, tally_.share(Duration::slide));
    scalar(quantities::kMeanStick, tally_.mean(Duration::stick));
    scalar(quantities::kMeanSlide, tally_.mean(Duration::slide));
    scalar(quantities::kMeanExcursion, tally_.mean(Duration::excursion));
  }

  void append_moments() {
    scalar(quantities::kEV2, tally_.stationary(Integrand::v_square));
    scalar(quantities::kEAbsV, tally_.stationary(Integrand::v_size));
    scalar(quantities::kEXV, tally_.stationary(Integrand::x_v));
    if (!process_.drifts()) {
      results_.push_back(quantities::scalar(quantities::kEV, 0, 0));
    } else {
      scalar(quantities::kEV, tally_.stationary(Integrand::v));
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
      for (const auto& [given, e] : tally_.averages(f)) {
        scalar("pi(" + question_.observables[f].name + given + ")", Kind::other,
               given == "|stick" ? e : of_function(question_.observables[f], e));
      }
    }
    scalar({"slip_rate"}, tally_.slip_rate());
    scalar(quantities::kFrictionPower,
           friction.weakens() ? tally_.averages(question_.observables.size())[0].second
                              : tally_.mean_of_speeds(friction.mu_d, friction.mirrored().mu_d));
  }

  void append_hitting_distribution() {
    const auto& noise = process_.noise;
    const int lowest = process_.lowest_static(), highest = process_.static_index();
    std::vector<double> levels;
    for (int i = lowest; i <= highest; ++i) levels.push_back(i);
    for (std::size_t side = 0; side < (process_.symmetric() ? 1 : 2); ++side) {
      over(side == 0 ? "entry_law" : "entry_law_minus", Kind::other, levels,
           [&](std::size_t n) { return tally_.entry(side, static_cast<int>(levels[n])); });
    }
    scalar(quantities::kFStick0,
           tally_.first_exit(noise.up_rate(highest), noise.down_rate(lowest)));
  }

  void append_laplace() {
    for (const auto& [key, duration] : names("F_")) transform(key, duration);
    for (const auto& [key, duration] : names("var_")) {
      scalar(key, Kind::other, tally_.variance(duration));
    }
  }

  void transform(const std::string& key, Duration duration) {
    over(key, Kind::transform, question_.lambda,
         [&](std::size_t n) { return tally_.laplace(n, duration); });
  }

  // Averages over cells, and the distribution function.
  void append_distribution(const std::string& name, Variable variable,
                           const std::vector<double>& at) {
    const auto cells = cells_around(at);
    over("f_" + name, Kind::other, at, [&](std::size_t n) {
      const auto [low, high] = cells[n];
      return divided(tally_.probability(variable, low, high), high - low);
    });
    over("cdf_" + name, Kind::distribution, at,
         [&](std::size_t n) { return tally_.probability(variable, 0, at[n]); });
  }

  void append_durations() {
    append_distribution("slide", Variable::slide, question_.time);
    append_distribution("stick", Variable::stick, question_.time);
    append_distribution("excursion", Variable::excursion, question_.time);
  }

  void append_slip() {
    for (const auto& [key, e] : tally_.slip()) {
      const bool net = key == "mean_slip_net";
      const Kind kind = net ? Kind::drift : Kind::positive_mean;
      scalar(key, kind, net && !process_.drifts() ? Estimate{} : e);
    }
    if (!question_.distance.empty()) {
      append_distribution("slip", Variable::path, question_.distance);
    }
    if (question_.inverse_distance.empty()) return;
    over("F_slip", Kind::transform, question_.inverse_distance,
         [&](std::size_t n) { return tally_.slip_transform(n); });
  }

  void append_peak() {
    const auto& w = question_.velocity;
    over("P_peak", Kind::probability, w, [&](std::size_t n) {
      return tally_.probability(Variable::peak, w[n], std::numeric_limits<double>::infinity());
    });
    for (std::size_t from : {0, 1}) {
      over(tally_.first_passage(w[0])[from].first, Kind::positive_mean, w,
           [&](std::size_t n) { return tally_.first_passage(w[n])[from].second; });
      results_.back().each_by_its_size = true;
    }
  }

  void append_spectrum() {
    if (!question_.omega.empty()) {
      over("S_v", Kind::spectrum, question_.omega,
           [&](std::size_t n) { return tally_.spectrum(n); });
    }
    const Estimate s = tally_.spectrum_at_zero();
    scalar(quantities::kS0, s);
    scalar(quantities::kDiffusivity, divided(s, 2));
  }

  void append_resolvent() {
    const auto& lambda = question_.lambda;
    const auto append = [&](const simulation::Named& first, const std::string& f, const auto& at) {
      for (std::size_t which = 0; which < first.size(); ++which) {
        const bool average = first[which].first == "pi";
        const std::string key = (average ? "pi_lambda" : first[which].first) + f;
        if (key.starts_with("u") && *std::min_element(lambda.begin(), lambda.end()) == 0) continue;
        over(key, Kind::other, lambda, [&](std::size_t n) { return at(n)[which].second; });
        // Beside averages it may not take their name.
        if (average && !question_.wants(Quantity::averages)) results_.back().key = "pi" + f;
      }
    };
    append(tally_.exits(0), "", [&](std::size_t n) { return tally_.exits(n); });
    const std::size_t largest =
        static_cast<std::size_t>(std::max_element(lambda.begin(), lambda.end()) - lambda.begin());
    for (std::size_t f = 0; f < question_.observables.size(); ++f) {
      append(tally_.resolvent(largest, f), "(" + question_.observables[f].name + ")",
             [&](std::size_t n) { return tally_.resolvent(n, f); });
    }
  }

  void append_displacement() {
    const bool still = !process_.drifts() && question_.start.kind != model::Start::Kind::state;
    over("displacement_mean", Kind::drift, question_.time,
         [&](std::size_t n) { return still ? Estimate{} : tally_.travel(n)[0].second; });
    over("displacement_variance", Kind::positive_mean, question_.time,
         [&](std::size_t n) { return tally_.travel(n)[1].second; });
  }

  void append_expectations() {
    for (std::size_t f = 0; f < question_.observables.size(); ++f) {
      const std::string of = "(" + question_.observables[f].name + ")";
      over("E" + of, Kind::other, question_.time, [&](std::size_t n) {
        return of_function(question_.observables[f], tally_.expectation(f, n));
      });
      scalar("stationary" + of, Kind::other,
             of_function(question_.observables[f], tally_.averages(f)[0].second));
    }
  }

  static std::vector<std::pair<std::string, Duration>> names(const std::string& prefix) {
    return {{prefix + "slide", Duration::slide},
            {prefix + "stick", Duration::stick},
            {prefix + "excursion", Duration::excursion}};
  }

  const options::Question& question_;
  const model::Process& process_;
  const Tally& tally_;
  Results results_;
};

}  // namespace

simulation::Wanted wanted_of(const options::Question& question, const model::Process& process) {
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

Results estimates(const options::Question& question, const model::Process& process,
                  const Tally& tally) {
  Results all = Estimates(question, process, tally).all();
  quantities::leave_out_missing_side(process, all);
  return all;
}

}  // namespace stickslip::monte_carlo
