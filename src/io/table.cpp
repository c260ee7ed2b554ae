#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stickslip/io/report.hpp"

namespace stickslip::io {
namespace {

std::string scene_line(const options::Request& request) {
  const auto& s = request.scene;
  std::string drag = s.drag_name;
  if (s.drag.linear > 0) drag += fmt::format(", c = {:g}", s.drag.linear);
  if (s.drag.cubic > 0) drag += fmt::format(", c3 = {:g}", s.drag.cubic);
  return fmt::format("mu_s = {:g}   mu_d = {:g}   tau = {:g}   delta = {:g}   drag {}\n",
                     s.friction.mu_s, s.friction.mu_d, s.tau, s.delta, drag);
}

std::string result_lines(const quantities::Result& r) {
  if (r.is_scalar()) {
    const double relative = r.error[0] == 0 ? 0 : r.error[0] / std::abs(r.value[0]);
    return fmt::format("{:<16} {:>24.17g}  {:>8.1e}  {:>8.1e}  {}\n", r.key, r.value[0], r.error[0],
                       relative, r.unit);
  }
  constexpr std::size_t most = 12;  // the files hold all
  std::string lines = fmt::format("{} by {}\n", r.key, r.abscissa_name);
  for (std::size_t n = 0; n < r.value.size(); ++n) {
    if (r.value.size() > most && n == most / 2) {
      n = r.value.size() - most / 2;
      lines += fmt::format("{:>16}\n", "...");
    }
    lines += fmt::format("{:>16g} {:>24.17g}  {:>8.1e}\n", r.abscissa[n], r.value[n], r.error[n]);
  }
  return lines;
}

// The discretisation in v.
std::string axis_cells(const accuracy::Resolution& r) {
  switch (r.scheme) {
  case options::Scheme::hp: return fmt::format("{:>6} {:>6}", r.degree, r.layers);
  case options::Scheme::upwind: return fmt::format("{:>13}", r.points);
  case options::Scheme::none: break;
  }
  return fmt::format("{:>13}", "exact");
}

const char* axis_title(options::Scheme scheme) {
  switch (scheme) {
  case options::Scheme::hp: return "degree layers";
  case options::Scheme::upwind: return "            p";
  case options::Scheme::none: break;
  }
  return "         in v";
}

std::string step_line(const accuracy::Step& step) {
  const auto& r = step.resolution;
  const auto& l = step.ledger;
  std::string line = fmt::format("{} {:>7} {:>8.4g} {:>9} {:>10} {:>8.0f} {:>9.3f} {:>9.3f} "
                                 "{:>9.3f} {:>9.3f} {:>9.3f}",
                                 axis_cells(r), r.levels, r.v_max, l.unknowns, l.nonzeros,
                                 l.factor_megabytes, l.assembly_seconds, l.analysis_seconds,
                                 l.factorization_seconds, l.solve_seconds, step.seconds);
  line += step.limiting_key.empty() ? "  to compare with"
                                    : fmt::format("  {:.1e} {}", step.estimate, step.limiting_key);
  return line + "\n";
}

std::string cost_table(const options::Request& request, const accuracy::Outcome& outcome) {
  if (outcome.steps.empty()) return "no system was assembled: closed formulas only\n";
  std::string text = fmt::format(
      "{} {:>7} {:>8} {:>9} {:>10} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9}  {}\n",
      axis_title(request.method.scheme), "levels", "v_max", "unknowns", "nonzeros", "MB",
      "assembly", "analysis", "factor", "solve", "total s", "largest relative error");
  for (const auto& step : outcome.steps) text += step_line(step);
  if (outcome.total.iterations > 0) {
    text += fmt::format("{} iterations in {} solves\n", outcome.total.iterations,
                        outcome.total.solves + outcome.total.corrections);
  }
  for (const auto& [name, value] : outcome.steps.back().checks) {
    text += fmt::format("{} = {:.4g}\n", name, value);
  }
  return text;
}

}  // namespace

std::string table(const options::Request& request, const accuracy::Outcome& outcome,
                  const RunTimes& times) {
  std::string text = scene_line(request);
  text += fmt::format("\n{:<16} {:>24}  {:>8}  {:>8}\n", "quantity", "value", "error", "relative");
  for (const auto& result : outcome.last.results) text += result_lines(result);
  if (request.wants(options::Quantity::density)) {
    text += fmt::format("{:<16} {:>24}  {:>8.1e}  of the distribution function of |V|\n", "density",
                        "in " + request.output, outcome.speed_law_error);
  }
  text += "\n" + cost_table(request, outcome);
  text +=
      fmt::format("accuracy {:g} {}; {:.2f} s in all, {:.2f} s of it start-up\n", request.accuracy,
                  outcome.reached ? "reached" : "NOT reached: " + outcome.shortfall, times.total,
                  times.start_up);
  return text;
}

}  // namespace stickslip::io
