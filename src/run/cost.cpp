#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "stickslip/base/uncertain.hpp"
#include "stickslip/run/campaign.hpp"
#include "stickslip/run/study.hpp"
#include "studies.hpp"

namespace stickslip::run {
namespace {

// The change after next is to the next one as that is to the last: a + R (a - b), where R is the
// ratio of changes one step before.
double continued(double a, double b, double c) { return a + (a - b) / (b - c) * (a - b); }

Table extrapolated_table(const std::string& key, const std::map<Place, Run>& runs,
                         const std::map<int, Run>& converged) {
  std::map<Place, double> values;
  for (const auto& [place, run] : runs) values[place] = value_of(run.results, key);
  extrapolate(values);
  Table table{key,
              key + " by the extrapolation of the paper, p = 2^k and delta = 2^-l; converged by hp",
              {{"k", Digits::parameter},
               {"l", Digits::parameter},
               {"extrapolated", Digits::compared},
               {"converged", Digits::compared},
               {"relative_error", Digits::error}},
              {}};
  for (const auto& [place, value] : values) {
    const auto [k, l] = place;
    if (is_computed(place)) continue;
    const double truth = value_of(converged.at(l).results, key);
    table.rows.push_back({static_cast<double>(k), static_cast<double>(l), value, truth,
                          std::abs(value / truth - 1)});
  }
  return table;
}

constexpr int kFinestDegree = 16;

/// One point of a work-precision picture.
struct Point {
  double parameter, error, seconds;
  linalg::SolverStatistics statistics;
};

/// The points of one method.
struct Curve {
  std::string method, parameter;
  std::vector<Point> points;
};

// The run of median time out of several.
Run median_run(int repeats, const std::function<Run()>& make) {
  std::vector<Run> runs;
  for (int n = 0; n < repeats; ++n) runs.push_back(make());
  const auto middle = runs.begin() + repeats / 2;
  std::nth_element(runs.begin(), middle, runs.end(),
                   [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
  return *middle;
}

class CostStudy {
 public:
  explicit CostStudy(const Context& context) : context_(context), repeats_(context.study.repeats) {
    study_.kind = "cost";
  }

  Study run_study() {
    require_upwind_memory(context_, context_.given, kFirstPoints << (upwind_steps() - 1));
    count_ = 1 + kLastDegree - kFirstDegree + 1 + upwind_steps() + kSimulations;
    reference_ = reference();
    hp();
    upwind();
    simulations();
    for (const Curve& curve : curves_) report(curve);
    return std::move(study_);
  }

 private:
  static constexpr int kFirstDegree = 2, kLastDegree = 12, kSimulations = 6, kFirstPoints = 4;

  [[nodiscard]] int upwind_steps() const { return context_.study.steps.value_or(7); }
  void announce(const std::string& what) { context_.report(++number_, count_, what); }

  // Finer than every point that is compared with it, in degree and in layers.
  quantities::Results reference() {
    announce("reference");
    const auto given = by_scheme(context_.given, cases::Scheme::hp);
    auto resolution = hp_resolution(given.scene, kFinestDegree, 0, 1e-18);
    resolution.layers += 2;
    return scalars(solve_on(context_.comm, given, resolution).evaluation.results);
  }

  // Largest relative error of a scalar.
  [[nodiscard]] double error_of(const quantities::Results& results) const {
    double largest = 0;
    for (const auto& result : results) {
      const double known = value_of(reference_, result.key);
      if (std::isnan(known)) continue;
      largest = std::max(largest, std::abs(result.value[0] / known - 1));
    }
    return largest;
  }

  void add(Curve& curve, const Run& run, double parameter, double error) {
    curve.points.push_back({parameter, error, run.seconds, run.statistics});
    study_.runs.push_back(run);
  }

  void hp() {
    Curve curve{"hp", "degree", {}};
    const auto given = by_scheme(context_.given, cases::Scheme::hp);
    for (int degree = kFirstDegree; degree <= kLastDegree; ++degree) {
      announce(fmt::format("hp, degree {}", degree));
      const auto resolution =
          hp_resolution(given.scene, degree, 0, std::max(std::pow(10.0, -(degree + 3)), 1e-18));
      Run run = median_run(repeats_, [&] {
        return solved_on(context_.comm, {"hp", {{"degree", degree}, {"layers", resolution.layers}}},
                         given, resolution);
      });
      set_errors(reference_, run.results);
      add(curve, run, degree, error_of(run.results));
    }
    curves_.push_back(std::move(curve));
  }

  void upwind() {
    Curve upwind{"upwind", "p", {}}, extrapolated{"richardson", "p", {}};
    for (int n = 0; n < upwind_steps(); ++n) {
      const int points = kFirstPoints << n;
      announce(fmt::format("upwind, p = {}", points));
      Run run = median_run(repeats_, [&] { return upwind_run(context_, context_.given, points); });
      set_errors(reference_, run.results);
      if (n > 0) add_extrapolated(extrapolated, study_.runs.back(), run, points);
      add(upwind, run, points, error_of(run.results));
    }
    curves_.push_back(std::move(upwind));
    curves_.push_back(std::move(extrapolated));
  }

  // 2 u^2p - u^p, at the cost of both.
  void add_extrapolated(Curve& curve, const Run& coarse, const Run& fine, double points) const {
    quantities::Results results = fine.results;
    for (auto& result : results) {
      result.value[0] = 2 * result.value[0] - value_of(coarse.results, result.key);
    }
    linalg::SolverStatistics both = coarse.statistics;
    both += fine.statistics;
    curve.points.push_back({points, error_of(results), coarse.seconds + fine.seconds, both});
  }

  // The error is the standard deviation of the interval: the error of a single run is random.
  void simulations() {
    Curve curve{"monte_carlo", "excursions", {}};
    cases::Case given = context_.given;
    given.question.accuracy_given = false;
    for (int n = 0; n < kSimulations; ++n) {
      given.method.excursions = 1000 * std::pow(4, n);
      announce(fmt::format("Monte Carlo, {:g} excursions", given.method.excursions));
      const Run run = median_run(repeats_, [&] { return simulated(given); });
      double error = 0;
      for (const auto& result : run.results) {
        error = std::max(error, quantities::relative_error(result) / kNormalQuantile);
      }
      add(curve, run, given.method.excursions, error);
    }
    curves_.push_back(std::move(curve));
  }

  [[nodiscard]] Run simulated(const cases::Case& given) const {
    auto simulation = simulate(context_.comm, given, "", {});
    return {"monte_carlo",
            {{"excursions", given.method.excursions}},
            scalars(simulation.results),
            simulation.state.seconds,
            {}};
  }

  void report(const Curve& curve) {
    Table table{curve.method,
                curve.method + ": largest relative error of a scalar; times in seconds",
                {{curve.parameter, Digits::parameter},
                 {"error", Digits::error},
                 {"seconds", Digits::measurement},
                 {"megabytes", Digits::measurement},
                 {"assembly", Digits::measurement},
                 {"analysis", Digits::measurement},
                 {"factorization", Digits::measurement},
                 {"solve", Digits::measurement}},
                {}};
    for (const Point& p : curve.points) {
      const auto& l = p.statistics;
      table.rows.push_back({p.parameter, p.error, p.seconds, l.factor_megabytes, l.assembly_seconds,
                            l.analysis_seconds, l.factorization_seconds, l.solve_seconds});
    }
    study_.tables.push_back(std::move(table));
    study_.conclusions.push_back(cost_of_a_digit(curve));
  }

  // time ~ error^-s by least squares in the logarithms, without points limited by rounding.
  [[nodiscard]] static std::string cost_of_a_digit(const Curve& curve) {
    std::vector<Point> used;
    for (const Point& p : curve.points) {
      if (p.error > 1e-12) used.push_back(p);
    }
    if (used.size() < 3) return curve.method + ": too few points for a rate of convergence";
    double x = 0, y = 0, xx = 0, xy = 0;
    const auto count = static_cast<double>(used.size());
    for (const Point& p : used) {
      x += -std::log10(p.error) / count;
      y += std::log10(p.seconds) / count;
    }
    for (const Point& p : used) {
      xx += std::pow(-std::log10(p.error) - x, 2);
      xy += (-std::log10(p.error) - x) * (std::log10(p.seconds) - y);
    }
    const double slope = xy / xx;
    const auto at = [&](double digits) { return std::pow(10, y + slope * (digits - x)); };
    return fmt::format("{}: one more digit takes {:.3g} times the time; error 1e-6 about {:.2g} s, "
                       "1e-9 {:.2g} s",
                       curve.method, std::pow(10, slope), at(6), at(9));
  }

  const Context& context_;
  int repeats_, number_ = 0, count_ = 0;
  quantities::Results reference_;
  std::vector<Curve> curves_;
  Study study_;
};

}  // namespace

bool is_computed(const Place& place) {
  const auto [k, l] = place;
  return l <= 4 || (l == 5 && k <= 6) || (l == 6 && k <= 4);
}

void extrapolate(std::map<Place, double>& s) {
  for (int l = 1; l <= kMostSteps; ++l) {
    for (int k = 1; k <= kMostPoints; ++k) {
      if (is_computed({k, l})) continue;
      const double vertical = continued(s[{k, l - 1}], s[{k, l - 2}], s[{k, l - 3}]);
      const double horizontal = continued(s[{k - 1, l}], s[{k - 2, l}], s[{k - 3, l}]);
      s[{k, l}] = (vertical + horizontal) / 2;
    }
  }
}

// All runs of the index set, and the converged values of the two finest steps.
Study study_heuristic(const Context& context) {
  constexpr double tail = 1e-6;  // extrapolation itself is right to a few digits
  const auto case_at = [&](int l) { return with_delta(context.given, std::ldexp(1, -l)); };
  std::vector<Place> places;
  for (int l = 1; l <= kMostSteps; ++l) {
    for (int k = 1; k <= kMostPoints; ++k) {
      if (is_computed({k, l})) places.emplace_back(k, l);
    }
  }
  for (const auto& [k, l] : places) require_upwind_memory(context, case_at(l), 1 << k, tail);
  int number = 0;
  const int count = static_cast<int>(places.size()) + 2;
  std::map<Place, Run> runs;
  std::map<int, Run> converged;
  for (const auto& [k, l] : places) {
    context.report(++number, count, fmt::format("p = {}, delta = 1/{}", 1 << k, 1 << l));
    runs[{k, l}] = upwind_run(context, case_at(l), 1 << k, tail);
  }
  for (int l : {5, 6}) {
    context.report(++number, count, fmt::format("hp, delta = 1/{}", 1 << l));
    converged[l] = converged_run(context, case_at(l), 1e-9);
  }
  Study study;
  study.kind = "heuristic";
  for (const auto& [place, run] : runs) study.runs.push_back(run);
  for (const auto& [l, run] : converged) study.runs.push_back(run);
  for (const auto& result : converged.at(6).results) {
    study.tables.push_back(extrapolated_table(result.key, runs, converged));
    double worst = 0;
    for (const auto& row : study.tables.back().rows) worst = std::max(worst, row[4]);
    study.conclusions.push_back(
        fmt::format("{}: largest relative error of extrapolated values {:.1e}", result.key, worst));
  }
  return study;
}

Study study_cost(const Context& context) { return CostStudy(context).run_study(); }

}  // namespace stickslip::run
