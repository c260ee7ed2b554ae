#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stickslip/io/parts.hpp"
#include "stickslip/support/statistics.hpp"

namespace stickslip::io {

namespace {

std::string noise_text(const model::Scene& s) {
  const auto& noise = s.noise;
  if (noise.name == "file") return "levels of " + noise.file;
  if (noise.name == "telegraph") {
    return fmt::format("telegraph a = {:g}, rate = {:g}", noise.amplitude, noise.rate);
  }
  const auto own = noise.deviation ? fmt::format("   deviation = {:g}", *noise.deviation) : "";
  return fmt::format("tau = {:g}   delta = {:g}{}", s.tau, s.delta, own);
}

}  // namespace

std::string scene_line(const model::Scene& s) {
  std::string drag = s.drag_name;
  if (s.drag.linear > 0) drag += fmt::format(", c = {:g}", s.drag.linear);
  if (s.drag.law) drag = "b(v) = " + s.drag_expression;
  if (s.drag.cubic > 0) drag += fmt::format(", c3 = {:g}", s.drag.cubic);
  std::string minus;
  if (!s.friction.symmetric()) {
    const auto backwards = s.friction.mirrored();
    minus = fmt::format("   mu_s_minus = {:g}   mu_d_minus = {:g}", backwards.mu_s, backwards.mu_d);
  }
  if (const auto& stribeck = s.friction.stribeck) {
    minus += fmt::format("   stribeck_velocity = {:g}   stribeck_exponent = {:g}",
                         stribeck->velocity, stribeck->exponent);
  }
  const std::string bias = s.bias == 0 ? "" : fmt::format("   bias = {:g}", s.bias);
  return fmt::format("mu_s = {:g}   mu_d = {:g}{}   {}   drag {}{}\n", s.friction.mu_s,
                     s.friction.mu_d, minus, noise_text(s), drag, bias);
}

std::string size_cells(const accuracy::Resolution& r, std::int64_t unknowns,
                       std::int64_t nonzeros) {
  std::string axis = fmt::format("{:>13}", "exact");
  if (r.scheme == options::Scheme::hp) axis = fmt::format("{:>6} {:>6}", r.degree, r.layers);
  if (r.scheme == options::Scheme::upwind) axis = fmt::format("{:>13}", r.points);
  return fmt::format("{} {:>7} {:>6} {:>8.4g} {:>9} {:>10}", axis, r.levels, r.noise_nodes(),
                     r.v_max, unknowns, nonzeros);
}

std::string size_titles(options::Scheme scheme) {
  const char* axis = "in v";
  if (scheme == options::Scheme::hp) axis = "degree layers";
  if (scheme == options::Scheme::upwind) axis = "p";
  return fmt::format("{:>13} {:>7} {:>6} {:>8} {:>9} {:>10}", axis, "levels", "nodes", "v_max",
                     "unknowns", "nonzeros");
}

std::string cell(double value, int digits) {
  return std::isnan(value) ? "" : fmt::format("{:.{}g}", value, digits);
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const auto& text : cells) {
    const bool plain = text.find_first_of(",\"\n") == text.npos;
    std::string inside;
    for (char c : text) inside += c == '"' ? "\"\"" : std::string(1, c);
    line += plain ? text + "," : "\"" + inside + "\",";
  }
  if (!line.empty()) line.pop_back();
  return line + "\n";
}

namespace {

constexpr std::size_t kKeyWidth = 16;

// Of the longest key.
std::size_t key_width(const quantities::Results& results) {
  std::size_t width = kKeyWidth;
  for (const auto& r : results) width = std::max(width, r.key.size());
  return width;
}

std::string result_lines(const quantities::Result& r, std::size_t width) {
  if (r.is_scalar()) {
    const double relative = r.error[0] == 0 ? 0 : r.error[0] / std::abs(r.value[0]);
    return fmt::format("{:<{}} {:>24.17g}  {:>8.1e}  {:>8.1e}  {}\n", r.key, width, r.value[0],
                       r.error[0], relative, r.unit);
  }
  constexpr std::size_t most = 12;  // the files hold all
  std::string lines = fmt::format("{} by {}\n", r.key, r.abscissa_name);
  for (std::size_t n = 0; n < r.value.size(); ++n) {
    if (r.value.size() > most && n == most / 2) {
      n = r.value.size() - most / 2;
      lines += fmt::format("{:>{}}\n", "...", width);
    }
    lines +=
        fmt::format("{:>{}g} {:>24.17g}  {:>8.1e}\n", r.abscissa[n], width, r.value[n], r.error[n]);
  }
  return lines;
}

std::string step_line(const accuracy::Step& step) {
  const auto& l = step.statistics;
  const std::string error = step.limiting_key.empty()
                                ? "to compare with"
                                : fmt::format("{:.1e} {}", step.estimate, step.limiting_key);
  return fmt::format("{} {:>8.0f} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f}  {}\n",
                     size_cells(step.resolution, l.unknowns, l.nonzeros), l.factor_megabytes,
                     l.assembly_seconds, l.analysis_seconds, l.factorization_seconds,
                     l.solve_seconds, step.seconds, error);
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

std::string comparison_line(const accuracy::Compared& c) {
  const auto& r = c.reference;
  const std::string argument = r.argument ? fmt::format("{:g}", *r.argument) : "";
  return fmt::format("{:<16} {:>9} {:>17.10g} {:>17.10g} [{:.7g}, {:.7g}] {:>7.2f}  {}\n",
                     r.quantity, argument, c.value, r.value, r.low, r.high, c.z,
                     verdict_text(c.verdict));
}

std::string comparison_table(const accuracy::Comparison& comparison, const std::string& file) {
  constexpr std::size_t most = 40;  // the files hold all
  std::string text =
      fmt::format("\nagainst {}\n{:<16} {:>9} {:>17} {:>17} {} {:>7}  {}\n", file, "quantity",
                  "argument", "value", "reference", "95 % interval", "z", "verdict");
  const auto& rows = comparison.rows;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool shown = rows.size() <= most || n < most / 2 || n >= rows.size() - most / 2 ||
                       rows[n].verdict == accuracy::Verdict::disagrees;
    if (shown) text += comparison_line(rows[n]);
    if (!shown && n == most / 2) text += "...\n";
  }
  for (const auto& name : comparison.left_out) text += name + ": not computed here\n";
  if (rows.empty()) return text + "NOTHING was compared; name the quantities of the file\n";
  const auto inside = std::count_if(
      rows.begin(), rows.end(), [](const auto& row) { return std::abs(row.z) < kNormalQuantile; });
  return text +
         fmt::format("{} of {} values within 1.96 standard deviations; {}\n", inside, rows.size(),
                     comparison.disagrees ? "the disagreement is significant at the level 1e-3"
                                          : "no significant disagreement");
}

std::string cost_table(const options::Request& request, const accuracy::Outcome& outcome) {
  if (outcome.simulation) return simulation_lines(*outcome.simulation);
  if (outcome.steps.empty()) return "no system was assembled: closed formulas only\n";
  std::string text = fmt::format("{} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}  {}\n",
                                 size_titles(request.method.scheme), "MB", "assembly", "analysis",
                                 "factor", "solve", "total s", "largest relative error");
  for (const auto& step : outcome.steps) text += step_line(step);
  if (outcome.total.iterations > 0) {
    text += fmt::format("{} iterations in {} solves and {} corrections\n", outcome.total.iterations,
                        outcome.total.solves, outcome.total.corrections);
  }
  for (const auto& [name, value] : outcome.steps.back().checks) {
    text += fmt::format("{} = {:.4g}\n", name, value);
  }
  return text;
}

}  // namespace

std::string table(const options::Request& request, const accuracy::Outcome& outcome,
                  const RunTimes& times) {
  std::string text = scene_line(request.scene);
  const std::size_t width = key_width(outcome.results);
  text += fmt::format("\n{:<{}} {:>24}  {:>8}  {:>8}\n", "quantity", width, "value", "error",
                      "relative");
  for (const auto& result : outcome.results) text += result_lines(result, width);
  if (request.question.wants(options::Quantity::density)) {
    text += fmt::format("{:<{}} {:>24}  {:>8.1e}  of the distribution function of |V|\n", "density",
                        width, "in " + request.output.output, outcome.speed_error);
  }
  if (outcome.path) {
    text += fmt::format("trajectory up to {:g}: {} events\n", request.question.horizon,
                        outcome.path->time.size());
  }
  if (outcome.comparison) text += comparison_table(*outcome.comparison, request.output.compared);
  text += "\n" + cost_table(request, outcome);
  // Simulations go on to the number of excursions unless an accuracy is asked for.
  if (!outcome.simulation || request.question.accuracy_given) {
    text += fmt::format("accuracy {:g} {}; ", request.question.accuracy,
                        outcome.reached ? "reached" : "NOT reached: " + outcome.shortfall);
  }
  text += fmt::format("{:.2f} s in all, {:.2f} s of it start-up\n", times.total, times.start_up);
  if (outcome.next_digit_seconds > 0) {
    text += fmt::format("one more digit would take about {:.2g} s\n", outcome.next_digit_seconds);
  }
  return text;
}

std::string csv(const simulation::Path& path) {
  std::string text = "time,x,y,v\n";
  for (std::size_t n = 0; n < path.time.size(); ++n) {
    text += fmt::format("{:.17g},{:.17g},{:g},{:.17g}\n", path.time[n], path.x[n], path.y[n],
                        path.v[n]);
  }
  return text;
}

}  // namespace stickslip::io
