#include "stickslip/run/study.hpp"

#include <boost/math/tools/roots.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "stickslip/base/errors.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/model/effect.hpp"
#include "studies.hpp"

namespace stickslip::run {
namespace {

// log2(|b - a|/|c - b|) for three values at p/2, p, 2p.
double observed_order(double a, double b, double c) {
  return std::log2(std::abs(b - a) / std::abs(c - b));
}

Table table_of(const std::string& key, const std::vector<Run>& runs, double limit) {
  Table table{key,
              key + " by the upwind scheme: observed order kappa(p), relative errors against hp",
              {{"p", Digits::parameter},
               {"value", Digits::compared},
               {"kappa", Digits::order},
               {"richardson", Digits::compared},
               {"error", Digits::error},
               {"richardson_error", Digits::error}},
              {}};
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const auto at = [&](std::size_t m) { return value_of(runs[m].results, key); };
    const bool between = n > 0 && n + 1 < runs.size();
    const double extrapolated = n > 0 ? 2 * at(n) - at(n - 1) : kNone;
    table.rows.push_back({runs[n].parameters[1].second, at(n),
                          between ? observed_order(at(n - 1), at(n), at(n + 1)) : kNone,
                          extrapolated, std::abs(at(n) / limit - 1),
                          std::abs(extrapolated / limit - 1)});
  }
  return table;
}

std::string conclusion(const Table& table, const quantities::Result& converged) {
  const auto& last = table.rows.back();
  const auto& before = table.rows[table.rows.size() - 2];
  const double change = std::abs(last[3] - before[3]);
  return fmt::format("{}: order {:.3f}; Richardson {} +- {:.1e}; hp {} +- {:.1e}", table.name,
                     before[2], number_text(last[3], change), change,
                     number_text(converged.value[0], converged.error[0]), converged.error[0]);
}

Study study_points(const Context& context) {
  Study study;
  study.kind = "p";
  const int steps = context.study.steps.value_or(8);
  require_upwind_memory(context, context.given, 1 << steps);
  for (int n = 1; n <= steps; ++n) {
    context.report(n, steps + 1, fmt::format("p = {}", 1 << n));
    study.runs.push_back(upwind_run(context, context.given, 1 << n));
  }
  context.report(steps + 1, steps + 1, "hp, for comparison");
  const Run converged = converged_run(context, context.given, 1e-10);
  for (auto& run : study.runs) set_errors(converged.results, run.results);
  for (const auto& result : converged.results) {
    // Closed forms do not come from the grid.
    if (std::isnan(value_of(study.runs[0].results, result.key))) continue;
    study.tables.push_back(table_of(result.key, study.runs, result.value[0]));
    study.conclusions.push_back(conclusion(study.tables.back(), result));
  }
  study.runs.push_back(converged);
  return study;
}

using Samples = std::span<const Sample>;

// d^q - e^q.
double gap(double d, double e, double q) { return std::pow(d, q) - std::pow(e, q); }

// Through all samples, with as many powers as that takes; the error is that of the samples.
Uncertain through(Samples samples, double first_power, double step) {
  const int n = static_cast<int>(samples.size());
  // Weights w with sum w = 1 and sum w delta^p = 0.
  linalg::Matrix<double> conditions(n, n);
  std::vector<double> weights(samples.size(), 0.0);
  weights[0] = 1;
  for (int s = 0; s < n; ++s) {
    conditions(0, s) = 1;
    const double d = samples[s].at / samples.back().at;
    for (int m = 1; m < n; ++m) conditions(m, s) = std::pow(d, first_power + (m - 1) * step);
  }
  linalg::LuFactors(std::move(conditions)).solve(weights, false);
  Uncertain limit{0, 0};
  for (int s = 0; s < n; ++s) {
    limit.value += weights[s] * samples[s].value;
    limit.error += std::abs(weights[s]) * samples[s].error;
  }
  return limit;
}

// Through as many of the last samples as make the error smallest. It compares with the limit
// without the last sample and, if `shorter`, with the one of a power less. Where errors of two
// signs cross, a change is small by chance, and the smallest of all is chosen: up to three times
// itself it counts as much as the change of a power less.
Uncertain best_through(Samples samples, double first_power, double step, bool shorter) {
  Uncertain best{kNone, kNone};
  double before = 0;
  for (std::size_t n = 2; n < samples.size(); ++n) {
    const Uncertain now = through(samples.last(n), first_power, step);
    const auto distance = [&](Samples others) {
      return std::abs(now.value - through(others, first_power, step).value);
    };
    double change = distance(samples.last(n + 1).first(n));
    if (shorter) change = std::max(change, distance(samples.last(n - 1)));
    const double error = std::max(change, std::min(3 * change, before)) + now.error;
    if (!(error >= best.error)) best = {now.value, error};
    before = change;
  }
  return best;
}

Uncertain by_observed_order(Samples samples, double order) {
  const auto from_two = [](const Sample& b, const Sample& c, double q) {
    return c.value - (b.value - c.value) * std::pow(c.at, q) / gap(b.at, c.at, q);
  };
  const std::size_t n = samples.size();
  const double before = observed_order(samples.first(n - 1));
  const double now = from_two(samples[n - 2], samples[n - 1], order);
  return {now, std::abs(now - from_two(samples[n - 3], samples[n - 2], before))};
}

/// A parameter that falls, the cases at its values, and how limits follow from orders.
struct Series {
  std::string parameter;  ///< delta, tau
  std::string name;       ///< behind the key in the names of tables
  std::string title;      ///< and in their titles
  double accuracy = 0;
  std::vector<double> values = {};
  std::vector<cases::Case> cases = {};
  std::function<Uncertain(std::span<const Sample>, double)> limit = {};
};

/// Of delta, with mu_s at the same place between the levels.
Series of_delta(const Context& context, double offset, const std::string& name) {
  const auto& friction = context.given.scene.friction;
  const double mu_s = friction.mu_s;
  const double first = std::max(1.0, std::round(mu_s / context.given.scene.delta - offset));
  // Chains that jump further, such as sums, have more states with each step.
  const bool wide = !context.given.scene.meant().noise.neighbours_only();
  Series series{"delta", " " + name, ", mu_s " + name,
                std::min(context.given.question.accuracy, wide ? 1e-6 : 1e-9)};
  const int steps = context.study.steps.value_or(wide ? 4 : 8);
  for (int n = 0; n < steps; ++n) {
    series.values.push_back(mu_s / ((wide ? first + n : first * (1 << n)) + offset));
    series.cases.push_back(with_delta(context.given, series.values.back()));
  }
  const bool grazing = friction.mu_d == mu_s;
  series.limit = [grazing](std::span<const Sample> samples, double order) {
    return limit_of(samples, order, grazing);
  };
  return series;
}

/// Of tau, with a chain that is the same but for its units of force and time. Its whole range, of
/// N = 2 (deviation/delta)^2 levels on each side, has the intensity 2 exactly. Series in tau^(1/2)
/// have a radius of convergence at which the first level is as strong as friction and bias: tau
/// begins with half of that in tau^(1/2), and only X = 0 lies in the static range from there on.
Series of_tau(const Context& context) {
  const auto& scene = context.given.scene;
  const double share = std::sqrt(2.0 / scene.full_levels());
  const double opposed =
      std::max(scene.friction.mu_s, scene.friction.mu_s_minus.value_or(0)) + std::abs(scene.bias);
  const double first = std::min(scene.tau, std::pow(share / (2 * opposed), 2));
  const auto& question = context.given.question;
  const double accuracy =
      question.usual_accuracy() > 0 ? question.accuracy : std::min(question.accuracy, 1e-8);
  Series series{"tau", "", ", tau -> 0", accuracy};
  for (int n = 0; n < context.study.steps.value_or(7); ++n) {
    cases::Case at = context.given;
    at.scene.tau = first * std::ldexp(1, -2 * n);
    at = with_delta(at, share / std::sqrt(at.scene.tau));
    effects::renew_drag(at.scene);
    series.values.push_back(at.scene.tau);
    series.cases.push_back(std::move(at));
  }
  series.limit = [](std::span<const Sample> samples, double) {
    return limit_in_half_powers(samples);
  };
  return series;
}

std::vector<Run> runs_of(const Context& context, const Series& series, int& number, int count) {
  std::vector<Run> runs;
  for (std::size_t n = 0; n < series.cases.size(); ++n) {
    context.report(++number, count,
                   fmt::format("{} = {:.6g}{}", series.parameter, series.values[n], series.title));
    runs.push_back(converged_run(context, series.cases[n], series.accuracy));
    auto& parameters = runs.back().parameters;
    if (series.parameter != parameters[0].first) {
      parameters.insert(parameters.begin(), {series.parameter, series.values[n]});
    }
  }
  return runs;
}

Table table_of_limits(const Series& series, const std::string& key, const std::vector<Run>& runs) {
  Table table{key + series.name,
              key + series.title,
              {{series.parameter, Digits::parameter},
               {"value", Digits::supported},
               {"error", Digits::error},
               {"order", Digits::order},
               {"limit", Digits::supported},
               {"limit_error", Digits::error}},
              {}};
  std::vector<Sample> samples;
  for (const auto& run : runs) {
    const auto found = std::ranges::find(run.results, key, &quantities::Result::key);
    const double at = run.parameters[0].second;
    if (found == run.results.end() || std::isnan(found->value[0])) {
      table.rows.push_back({at, kNone, kNone, kNone, kNone, kNone});
      continue;
    }
    samples.push_back({at, found->value[0], found->error[0]});
    const double order = observed_order(samples);
    const Uncertain limit = series.limit(samples, order);
    table.rows.push_back({at, found->value[0], found->error[0], order, limit.value, limit.error});
  }
  return table;
}

// What the last two rows say of a quantity without a limit, and of one whose limit is 0.
std::string conclusion(Table table) {
  std::erase_if(table.rows, [](const auto& row) { return std::isnan(row[1]); });
  if (table.rows.empty()) return table.name + ": no values";
  const auto& last = table.rows.back();
  const double value = std::abs(last[1]), order = last[3], limit = last[4], error = last[5];
  const auto& name = table.columns[0].name;
  if (std::isnan(limit)) {
    const auto& before = table.rows[table.rows.size() < 2 ? 0 : table.rows.size() - 2];
    const double growth = std::log(value / std::abs(before[1])) / std::log(last[0] / before[0]);
    if (growth < -0.1)
      return fmt::format("{}: no limit; grows like {}^{:.2f}", table.name, name, growth);
    return table.name + ": no order of convergence; the changes are too small or irregular";
  }
  const std::string ordered = std::isnan(order) ? "" : fmt::format("order {:.2f}, ", order);
  const bool vanishes = std::abs(limit) <= error && error < value / 2;
  return fmt::format("{}: {}limit {} +- {:.1e}{}", table.name, ordered, number_text(limit, error),
                     error, vanishes ? ", which is 0: vanishes in the limit" : "");
}

// Of the run with most values: some may have failed.
std::vector<std::string> keys_of(const std::vector<Run>& runs) {
  const auto values = [](const Run& run) {
    return std::ranges::count_if(run.results, quantities::all_numbers);
  };
  const auto fewer = [&](const Run& a, const Run& b) { return values(a) < values(b); };
  const auto most = std::max_element(runs.rbegin(), runs.rend(), fewer);
  std::vector<std::string> keys;
  for (const auto& result : most->results) keys.push_back(result.key);
  return keys;
}

Study study_of(const Context& context, const std::vector<Series>& all) {
  Study study;
  study.kind = all[0].parameter;
  int number = 0, count = 0;
  for (const auto& series : all) count += static_cast<int>(series.cases.size());
  for (const auto& series : all) {
    const auto runs = runs_of(context, series, number, count);
    for (const auto& key : keys_of(runs)) {
      study.tables.push_back(table_of_limits(series, key, runs));
      study.conclusions.push_back(conclusion(study.tables.back()));
    }
    study.runs.insert(study.runs.end(), runs.begin(), runs.end());
  }
  return study;
}

// Has a run found its results; where that fails it has none, and says why.
Run attempted(MPI_Comm comm, Run run, const std::function<void(Run&)>& find) {
  try {
    find(run);
  } catch (...) {
    const Failure failure = linalg::failure_in_flight();
    if (linalg::ranks(comm) > 1) throw;  // of which one may fail alone
    run.failure = failure.what();
  }
  return run;
}

Study study_steps(const Context& context) {
  return study_of(context,
                  {of_delta(context, 0, "on a level"), of_delta(context, 0.5, "between levels")});
}

Study study_white_noise(const Context& context) { return study_of(context, {of_tau(context)}); }

}  // namespace

// (a - b)/(b - c) = (d_a^q - d_b^q)/(d_b^q - d_c^q).
double observed_order(Samples samples) {
  if (samples.size() < 3) return kNone;
  const Samples last = samples.last(3);
  const Sample &a = last[0], &b = last[1], &c = last[2];
  const double ratio = (a.value - b.value) / (b.value - c.value);
  const auto defect = [&](double q) {
    return std::log(gap(a.at, b.at, q) / gap(b.at, c.at, q)) - std::log(ratio);
  };
  constexpr double low = 0.05, high = 8;
  const bool changes = std::abs(b.value - c.value) > b.error + c.error;
  if (!changes || !(ratio > 0) || !(defect(low) * defect(high) <= 0)) return kNone;
  std::uintmax_t iterations = 100;
  const auto root = boost::math::tools::toms748_solve(
      defect, low, high, boost::math::tools::eps_tolerance<double>(40), iterations);
  return root.first;
}

Uncertain limit_of(Samples samples, double order, bool grazing) {
  if (std::isnan(order)) return {kNone, kNone};
  double first_power = 1;
  if (grazing) first_power = order < 1.75 ? 1.5 : 2;
  if (std::abs(order - first_power) > 0.25) return by_observed_order(samples, order);
  return best_through(samples, first_power, grazing ? 0.5 : 1, false);
}

Uncertain limit_in_half_powers(Samples samples) {
  const Uncertain none{kNone, kNone};
  if (samples.size() < 3) return none;
  const Samples last = samples.last(3);
  const double before = std::abs(last[1].value - last[0].value),
               change = std::abs(last[2].value - last[1].value);
  if (change > before + last[0].error + 2 * last[1].error + last[2].error) return none;
  return best_through(samples, 0.5, 0.5, true);
}

Study run_study(MPI_Comm comm, const cases::Case& given, const StudyOptions& study,
                const StudyProgress& progress) {
  const Context context{comm, given, study, progress};
  const std::pair<StudyKind, Study (*)(const Context&)> all[] = {
      {StudyKind::points, study_points},
      {StudyKind::steps, study_steps},
      {StudyKind::white_noise, study_white_noise},
      {StudyKind::heuristic, study_heuristic},
      {StudyKind::cost, study_cost}};
  Study found;
  for (const auto& [kind, carry_out] : all) {
    if (kind == study.kind) found = carry_out(context);
  }
  for (const auto& run : found.runs) {
    if (run.failure.empty()) continue;
    found.complete = false;
    const auto& [parameter, value] = run.parameters.front();
    found.conclusions.push_back(
        fmt::format("{}, {} = {:g}: {}", run.method, parameter, value, run.failure));
  }
  return found;
}

quantities::Results scalars(const quantities::Results& results) {
  quantities::Results found;
  for (const auto& result : results) {
    for (std::size_t n = 0; n < result.value.size(); ++n) {
      const bool asked = !result.diagnostic || !result.is_scalar();
      if (result.value[n] == 0 || !asked) continue;
      auto& one = found.emplace_back(result);
      if (!result.is_scalar()) {
        one.key += fmt::format(" {}={:g}", result.abscissa_name, result.abscissa[n]);
      }
      one.abscissa_name.clear();
      one.abscissa.clear();
      one.value = {result.value[n]};
      one.error = {result.error[n]};
      if (!result.ci95.empty()) one.ci95 = {result.ci95[n]};
    }
  }
  return found;
}

double value_of(const quantities::Results& results, const std::string& key) {
  for (const auto& result : results) {
    if (result.key == key) return result.value[0];
  }
  return kNone;
}

void set_errors(const quantities::Results& known, quantities::Results& results) {
  for (auto& result : results) {
    const double value = value_of(known, result.key);
    if (!std::isnan(value)) result.error[0] = std::abs(result.value[0] - value);
  }
}

cases::Case by_scheme(const cases::Case& given, cases::Scheme scheme) {
  cases::Case other = given;
  other.method = {.scheme = scheme};
  return other;
}

cases::Case with_delta(const cases::Case& given, double delta) {
  cases::Case other = given;
  other.scene.delta = delta;
  effects::make_noise_levels(other.scene);
  other.scene.noise_levels.reset();
  other.method = {};
  return other;
}

void require_upwind_memory(const Context& context, const cases::Case& given, int points,
                           double tail) {
  const auto upwind = by_scheme(given, cases::Scheme::upwind);
  try {
    require_memory(context.comm, upwind.scene, upwind_resolution(upwind.scene, points, tail));
  } catch (const NoMemory& lack) {
    const bool fixed = context.study.kind == StudyKind::heuristic;
    throw NoMemory(fmt::format("upwind with p = {}, delta = {:g}: {}{}", points, upwind.scene.delta,
                               lack.what(), fixed ? "" : ", or fewer -study_steps"));
  }
}

Run solved_on(MPI_Comm comm, Run run, const cases::Case& given, const Resolution& resolution) {
  return attempted(comm, std::move(run), [&](Run& found) {
    auto [evaluation, step] = solve_on(comm, given, resolution);
    found.results = scalars(evaluation.results);
    found.seconds = step.seconds;
    found.statistics = step.statistics;
  });
}

Run upwind_run(const Context& context, const cases::Case& given, int points, double tail) {
  const auto upwind = by_scheme(given, cases::Scheme::upwind);
  return solved_on(context.comm, {"upwind", {{"delta", upwind.scene.delta}, {"p", points}}}, upwind,
                   upwind_resolution(upwind.scene, points, tail));
}

Run converged_run(const Context& context, const cases::Case& given, double accuracy) {
  auto hp = by_scheme(given, cases::Scheme::hp);
  hp.question.accuracy = accuracy;
  return attempted(context.comm, {"hp", {{"delta", hp.scene.delta}, {"accuracy", accuracy}}},
                   [&](Run& run) {
                     const auto outcome = carry_out(context.comm, hp, {}, {});
                     for (const auto& step : outcome.steps) run.seconds += step.seconds;
                     run.results = scalars(outcome.results);
                     run.statistics = outcome.total;
                     run.failure = outcome.failures;
                   });
}

}  // namespace stickslip::run
