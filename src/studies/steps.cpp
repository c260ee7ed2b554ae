#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <span>

#include "stickslip/effects/effect.hpp"
#include "stickslip/studies/limit.hpp"
#include "stickslip/support/number_text.hpp"
#include "studies.hpp"

namespace stickslip::studies {
namespace {

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
  // A lattice in the plane has states in proportion to the square of a step, and times to their
  // square again.
  const bool plane = !context.given.scene.meant().noise.neighbours_only();
  Series series{"delta", " " + name, ", mu_s " + name,
                std::min(context.given.question.accuracy, plane ? 1e-6 : 1e-9)};
  const int steps = context.study.steps.value_or(plane ? 4 : 8);
  for (int n = 0; n < steps; ++n) {
    series.values.push_back(mu_s / ((plane ? first + n : first * (1 << n)) + offset));
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

}  // namespace

Study study_steps(const Context& context) {
  return study_of(context,
                  {of_delta(context, 0, "on a level"), of_delta(context, 0.5, "between levels")});
}

Study study_white_noise(const Context& context) { return study_of(context, {of_tau(context)}); }

}  // namespace stickslip::studies
