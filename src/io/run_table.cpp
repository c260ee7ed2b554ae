#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stickslip/effects/effect.hpp"
#include "stickslip/io/parts.hpp"
#include "stickslip/model/effective_friction.hpp"
#include "stickslip/support/number_text.hpp"
#include "stickslip/support/statistics.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::io {

namespace {

std::string unit_behind(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

}  // namespace

std::string scene_text(const model::Scene& s) {
  std::vector<std::string> parts;
  const auto add = [&](const char* name, double value) {
    parts.push_back(fmt::format("{} = {:g}", name, value));
  };
  const auto add_static = [&](const char* name, double given, std::optional<double> effective) {
    add(name, given);
    if (effective) parts.back() += fmt::format(" (acts as {:g})", *effective);
  };
  const auto backwards = s.friction.mirrored();
  const auto along = model::effective_mu_s(s, false), against = model::effective_mu_s(s, true);
  add_static("mu_s", s.friction.mu_s, along);
  add("mu_d", s.friction.mu_d);
  if (!s.friction.symmetric() || against != along)
    add_static("mu_s_minus", backwards.mu_s, against);
  if (!s.friction.symmetric()) add("mu_d_minus", backwards.mu_d);
  for (const auto* choice : effects::choices()) {
    for (auto& part : effects::heading(choice->in(s), s)) parts.push_back(std::move(part));
  }
  if (s.bias != 0) add("bias", s.bias);
  if (s.force) {
    const auto n = s.force->peak();
    parts.push_back(fmt::format("force of {}, at most {:.5g}{} at time {:g}{}", s.force->file,
                                std::abs(s.force->force[n]), unit_behind(s.force->unit),
                                s.force->time[n], s.force->unit.empty() ? "" : " s"));
    if (s.force->gravity > 0) add("force_gravity", s.force->gravity);
  }
  return spaced(parts);
}

std::string cell(double value, int digits) {
  return std::isnan(value) ? "" : fmt::format("{:.{}g}", value, digits);
}

namespace {

constexpr std::size_t kLongestKey = 40;  // longer ones have a line of their own

void add_scalar(const quantities::Result& r, TextTable& table) {
  const double value = r.value[0], error = r.error[0];
  const bool alone = r.key.size() > kLongestKey;
  if (alone) table.add_line(r.key);
  table.add({alone ? "" : r.key, number_text(value, error), error_text(error),
             error_text(error == 0 ? 0 : error / std::abs(value)), r.unit});
}

void add_array(const quantities::Result& r, TextTable& table) {
  constexpr std::size_t most = 12;  // the files hold all
  const std::string unit = r.unit.empty() ? "" : fmt::format(" [{}]", r.unit);
  table.add_line(fmt::format("{} by {}{}", r.key, r.abscissa_name, unit));
  const std::size_t size = r.value.size();
  const auto shown = [&](std::size_t n) {
    return size <= most || n < most / 2 || n >= size - most / 2;
  };
  std::size_t width = 0;
  for (std::size_t n = 0; n < size; ++n) {
    if (shown(n)) width = std::max(width, fmt::format("{:g}", r.abscissa[n]).size());
  }
  for (std::size_t n = 0; n < size; ++n) {
    if (!shown(n) && shown(n - 1)) table.add({fmt::format("  {:>{}}", "...", width)});
    if (!shown(n)) continue;
    table.add({fmt::format("  {:>{}g}", r.abscissa[n], width), number_text(r.value[n], r.error[n]),
               error_text(r.error[n])});
  }
}

std::string results_table(const quantities::Results& results) {
  if (results.empty()) return "";
  TextTable table({{"quantity", true}, {"value"}, {"error"}, {"rel. error"}, {"unit", true}});
  for (const auto& r : results) r.is_scalar() ? add_scalar(r, table) : add_array(r, table);
  return table.text();
}

// What stands in files alone.
std::string elsewhere(const options::Request& request, const accuracy::Outcome& outcome) {
  std::string text;
  if (request.question.wants(catalogue::Quantity::density)) {
    const auto files = request.files.holding(catalogue::Quantity::density);
    text += fmt::format("density: in {}; error of the distribution function of |V| {}\n",
                        enumerate(files, "and"), error_text(outcome.speed_error));
  }
  if (outcome.path) {
    text += fmt::format("trajectory up to time {:g}: {} events\n", request.question.horizon,
                        outcome.path->time.size());
  }
  return text;
}

void add_row(const accuracy::Compared& c, TextTable& table) {
  const auto& r = c.reference;
  // A simulation may have bounded a value from one side alone.
  const double down = r.value - r.low, up = r.high - r.value;
  const double half = std::isfinite(up) ? std::max(down, up) : down;
  // A digit more than the value of an interval has: its ends are what matters.
  const std::string interval =
      fmt::format("[{}, {}]", number_text(r.low, half / 10), number_text(r.high, half / 10));
  const bool long_z = std::abs(c.z) >= 1e4;
  table.add({r.quantity, r.argument ? fmt::format("{:g}", *r.argument) : "",
             number_text(c.value, c.error), number_text(r.value, half), interval,
             long_z ? fmt::format("{:.1e}", c.z) : fmt::format("{:.2f}", c.z),
             verdict_text(c.verdict)});
}

std::string comparison_table(const accuracy::Comparison& comparison, const std::string& file) {
  constexpr std::size_t most = 40;  // the files hold all
  TextTable table({{"quantity", true},
                   {"argument"},
                   {"value"},
                   {"reference"},
                   {"interval", true, "95 % confidence"},
                   {"z"},
                   {"verdict", true}},
                  1);
  const auto& rows = comparison.rows;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool shown = rows.size() <= most || n < most / 2 || n >= rows.size() - most / 2 ||
                       rows[n].verdict == accuracy::Verdict::disagrees;
    if (shown) add_row(rows[n], table);
    if (!shown && n == most / 2) table.add_line("...");
  }
  std::string text = fmt::format("\ncomparison with {}\n", file);
  if (!rows.empty()) text += table.text();
  for (const auto& name : comparison.left_out) text += name + ": not computed here\n";
  if (rows.empty()) {
    return text + "NOTHING was compared: ask for the quantities of the file with -quantities\n";
  }
  const auto inside = std::count_if(
      rows.begin(), rows.end(), [](const auto& row) { return std::abs(row.z) < kNormalQuantile; });
  return text +
         fmt::format("{} of {} values within 1.96 standard deviations; {}\n", inside, rows.size(),
                     comparison.disagrees ? "significant disagreement at the family-wise level 1e-3"
                                          : "no significant disagreement");
}

std::string verdict_on_accuracy(const cases::Question& question, const accuracy::Outcome& outcome) {
  // Simulations go on to the number of excursions unless an accuracy is asked for.
  if (outcome.simulation && !question.accuracy_given) return "";
  return outcome.reached ? fmt::format("accuracy {:g} reached\n", question.accuracy)
                         : wrap(fmt::format("accuracy {:g} NOT reached: {}", question.accuracy,
                                            outcome.shortfall),
                                kLineWidth - 2, 2) +
                               "\n";
}

}  // namespace

std::string run_table(const options::Request& request, const accuracy::Outcome& outcome,
                      const RunTimes& times) {
  std::string text = scene_text(request.scene) + "\n" + results_table(outcome.results);
  if (outcome.simulation) text += "errors are half widths of 95 % confidence intervals\n";
  text += elsewhere(request, outcome);
  if (outcome.comparison) text += comparison_table(*outcome.comparison, request.files.compared);
  text += "\n" + cost_table(request.method.scheme, outcome);
  text += verdict_on_accuracy(request.question, outcome);
  text += fmt::format("{:.2f} s in total, {:.2f} s of it start-up\n", times.total, times.start_up);
  if (outcome.next_digit_seconds > 0) {
    text += fmt::format("one more digit would take about {:.2g} s\n", outcome.next_digit_seconds);
  }
  return text;
}

}  // namespace stickslip::io
