#include <fmt/format.h>

#include "stickslip/support/number_text.hpp"
#include "studies.hpp"

namespace stickslip::studies {
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

}  // namespace

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

}  // namespace stickslip::studies
