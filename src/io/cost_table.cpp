#include <fmt/format.h>

#include <algorithm>

#include "stickslip/io/parts.hpp"
#include "stickslip/support/number_text.hpp"

namespace stickslip::io {

// A velocity discretisation comes with a linear system; the fluid queue has neither.
std::vector<TextTable::Column> size_columns(cases::Scheme scheme) {
  std::vector<TextTable::Column> columns;
  if (scheme == cases::Scheme::hp) columns = {{"degree"}, {"layers"}};
  if (scheme == cases::Scheme::upwind) columns = {{"p"}};
  columns.push_back({"levels", false, "noise"});
  columns.push_back({"nodes", false, "noise"});
  if (scheme == cases::Scheme::none) return columns;
  columns.insert(columns.end(), {{"v_max"}, {"unknowns"}, {"nonzeros"}});
  return columns;
}

std::string count_text(double count) { return count > 0 ? fmt::format("{:.2e}", count) : "-"; }

std::vector<std::string> size_cells(const accuracy::Resolution& r, std::int64_t unknowns,
                                    std::int64_t nonzeros) {
  std::vector<std::string> cells;
  if (r.scheme == cases::Scheme::hp) {
    cells = {std::to_string(r.degree), std::to_string(r.layers)};
  }
  if (r.scheme == cases::Scheme::upwind) cells = {std::to_string(r.points)};
  cells.push_back(std::to_string(r.levels));
  cells.push_back(std::to_string(r.noise_nodes()));
  if (r.scheme == cases::Scheme::none) return cells;
  cells.push_back(fmt::format("{:.4g}", r.v_max));
  cells.push_back(std::to_string(unknowns));
  cells.push_back(count_text(static_cast<double>(nonzeros)));
  return cells;
}

namespace {

std::string checks_table(const accuracy::Step& step) {
  std::string text;
  for (const auto& [name, value, meaning] : step.checks) {
    text += fmt::format("{} = {:.4g}: {}\n", name, value, meaning);
  }
  return text;
}

std::string simulation_lines(const monte_carlo::Simulated& simulated) {
  const auto& s = simulated.state;
  std::string text = fmt::format("{:.8g} excursions, ", s.excursions);
  if (simulated.continued_from > 0) {
    text += fmt::format("{:.8g} of them from the checkpoint, ", simulated.continued_from);
  }
  return text + fmt::format("{:.4g} jumps of the noise in {:.2f} s ({:.3g} ns a jump)\n", s.jumps,
                            s.seconds, s.jumps > 0 ? 1e9 * s.seconds / s.jumps : 0);
}

// Symbolic and numerical factorisation together; the files hold both.
std::vector<std::string> step_cells(const accuracy::Step& step) {
  const auto& s = step.statistics;
  auto cells = size_cells(step.resolution, s.unknowns, s.nonzeros);
  if (step.resolution.scheme != cases::Scheme::none) {
    cells.push_back(fmt::format("{:.0f}", s.factor_megabytes));
    for (double seconds :
         {s.assembly_seconds, s.analysis_seconds + s.factorization_seconds, s.solve_seconds}) {
      cells.push_back(seconds_text(seconds));
    }
  }
  cells.push_back(seconds_text(step.seconds));
  cells.push_back(step.limiting_key.empty() ? "-" : error_text(step.estimate));
  return cells;
}

// The first discretisations have too few before them for an estimate.
std::string estimate_lines(const std::vector<accuracy::Step>& steps) {
  const auto first = std::find_if(steps.begin(), steps.end(), [](const accuracy::Step& step) {
    return !step.limiting_key.empty();
  });
  if (first == steps.end()) return "";
  std::string text;
  if (first != steps.begin()) {
    text = fmt::format("-: no estimate yet; an error estimate compares {} discretisations\n",
                       first - steps.begin() + 1);
  }
  const std::string& key = steps.back().limiting_key;
  return key.empty() ? text : text + "largest relative error, last row: " + key + "\n";
}

}  // namespace

std::string cost_table(cases::Scheme scheme, const accuracy::Outcome& outcome) {
  if (outcome.simulation) return simulation_lines(*outcome.simulation);
  if (outcome.steps.empty()) return "closed-form results only: no linear system was assembled\n";
  auto columns = size_columns(scheme);
  if (scheme != cases::Scheme::none) {
    columns.insert(columns.end(), {{"MB", false, "factors"},
                                   {"s", false, "assembly"},
                                   {"s", false, "factor"},
                                   {"s", false, "solve"}});
  }
  columns.push_back({"s", false, "total"});
  columns.push_back({"error", false, "rel."});
  TextTable table(std::move(columns), 1);
  for (const auto& step : outcome.steps) table.add(step_cells(step));
  std::string text = table.text() + estimate_lines(outcome.steps);
  const auto& total = outcome.total;
  if (total.iterations > 0) {
    text += fmt::format("{} Krylov iterations in {} solves and {} steps of iterative refinement\n",
                        total.iterations, total.solves, total.corrections);
  }
  return text + checks_table(outcome.steps.back());
}

}  // namespace stickslip::io
