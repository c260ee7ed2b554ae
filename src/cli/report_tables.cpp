#include "stickslip/cli/reports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stickslip/base/text.hpp"
#include "stickslip/base/uncertain.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::cli {
namespace {

std::string without_blanks_at_end(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string unit_behind(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

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
std::string elsewhere(const Request& request, const run::Outcome& outcome) {
  std::string text;
  if (request.question.wants(cases::Quantity::density)) {
    const auto files = request.files.holding(cases::Quantity::density);
    text += fmt::format("density: in {}; error of the distribution function of |V| {}\n",
                        enumerate(files, "and"), error_text(outcome.speed_error));
  }
  if (outcome.path) {
    text += fmt::format("trajectory up to time {:g}: {} events\n", request.question.horizon,
                        outcome.path->time.size());
  }
  return text;
}

void add_row(const run::Compared& c, TextTable& table) {
  const auto& r = c.reference;
  // A simulation may have bounded a value from one side alone.
  const double down = r.value - r.low, up = r.high - r.value;
  const double half = std::isfinite(up) ? std::max(down, up) : down;
  // A digit more than the value of an interval has: its ends are what matters.
  const std::string interval =
      fmt::format("[{}, {}]", number_text(r.low, half / 10), number_text(r.high, half / 10));
  const bool long_z = std::abs(c.z) >= 1e4;
  const std::string z = long_z ? fmt::format("{:.1e}", c.z) : fmt::format("{:.2f}", c.z);
  table.add_titled({{{"quantity", true}, r.quantity},
                    {{"argument"}, r.argument ? fmt::format("{:g}", *r.argument) : ""},
                    {{"value"}, number_text(c.value, c.error)},
                    {{"reference"}, number_text(r.value, half)},
                    {{"interval", true, "95 % confidence"}, interval},
                    {{"z"}, z},
                    {{"verdict", true}, verdict_text(c.verdict)}});
}

std::string comparison_table(const run::Comparison& comparison, const std::string& file) {
  constexpr std::size_t most = 40;  // the files hold all
  TextTable table({}, 1);
  const auto& rows = comparison.rows;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool shown = rows.size() <= most || n < most / 2 || n >= rows.size() - most / 2 ||
                       rows[n].verdict == run::Verdict::disagrees;
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

std::string verdict_on_accuracy(const cases::Question& question, const run::Outcome& outcome) {
  // Simulations go on to the number of excursions unless an accuracy is asked for.
  if (outcome.simulation && !question.accuracy_given) return "";
  return outcome.reached ? fmt::format("accuracy {:g} reached\n", question.accuracy)
                         : wrap(fmt::format("accuracy {:g} NOT reached: {}", question.accuracy,
                                            outcome.shortfall),
                                kLineWidth - 2, 2) +
                               "\n";
}

std::string checks_table(const run::Step& step) {
  std::string text;
  for (const auto& [name, value, meaning] : step.checks) {
    text += fmt::format("{} = {:.4g}: {}\n", name, value, meaning);
  }
  return text;
}

std::string simulation_lines(const run::Simulated& simulated) {
  const auto& s = simulated.state;
  std::string text = fmt::format("{:.8g} excursions, ", s.excursions);
  if (simulated.continued_from > 0) {
    text += fmt::format("{:.8g} of them from the checkpoint, ", simulated.continued_from);
  }
  return text + fmt::format("{:.4g} jumps of the noise in {:.2f} s ({:.3g} ns a jump)\n", s.jumps,
                            s.seconds, s.jumps > 0 ? 1e9 * s.seconds / s.jumps : 0);
}

// Symbolic and numerical factorisation together; the files hold both.
std::vector<TextTable::Cell> step_cells(const run::Step& step) {
  const auto& s = step.statistics;
  auto cells = size_cells(step.resolution, s.unknowns, s.nonzeros);
  const auto add_seconds = [&cells](const char* of, double seconds) {
    cells.push_back({{"s", false, of}, seconds_text(seconds)});
  };
  if (step.resolution.scheme != cases::Scheme::none) {
    cells.push_back({{"MB", false, "factors"}, fmt::format("{:.0f}", s.factor_megabytes)});
    add_seconds("assembly", s.assembly_seconds);
    add_seconds("factor", s.analysis_seconds + s.factorization_seconds);
    add_seconds("solve", s.solve_seconds);
  }
  add_seconds("total", step.seconds);
  cells.push_back(
      {{"error", false, "rel."}, step.limiting_key.empty() ? "-" : error_text(step.estimate)});
  return cells;
}

// The first discretisations have too few before them for an estimate.
std::string estimate_lines(const std::vector<run::Step>& steps) {
  const auto first = std::find_if(steps.begin(), steps.end(),
                                  [](const run::Step& step) { return !step.limiting_key.empty(); });
  if (first == steps.end()) return "";
  std::string text;
  if (first != steps.begin()) {
    text = fmt::format("-: no estimate yet; an error estimate compares {} discretisations\n",
                       first - steps.begin() + 1);
  }
  const std::string& key = steps.back().limiting_key;
  return key.empty() ? text : text + "largest relative error, last row: " + key + "\n";
}

std::string cost_table(const run::Outcome& outcome) {
  if (outcome.simulation) return simulation_lines(*outcome.simulation);
  if (outcome.steps.empty()) return "closed-form results only: no linear system was assembled\n";
  TextTable table({}, 1);
  for (const auto& step : outcome.steps) table.add_titled(step_cells(step));
  std::string text = table.text() + estimate_lines(outcome.steps);
  const auto& total = outcome.total;
  if (total.iterations > 0) {
    text += fmt::format("{} Krylov iterations in {} solves and {} steps of iterative refinement\n",
                        total.iterations, total.solves, total.corrections);
  }
  return text + checks_table(outcome.steps.back());
}

}  // namespace

TextTable::TextTable(std::vector<Column> columns, std::size_t gap)
    : columns_(std::move(columns)), gap_(gap) {}

void TextTable::add(std::vector<std::string> cells) {
  cells.resize(columns_.size());
  rows_.push_back({std::move(cells), ""});
}

void TextTable::add_titled(const std::vector<Cell>& cells) {
  if (columns_.empty()) std::ranges::transform(cells, std::back_inserter(columns_), &Cell::first);
  std::ranges::transform(cells, std::back_inserter(rows_.emplace_back().cells), &Cell::second);
}

void TextTable::add_line(std::string line) { rows_.push_back({{}, std::move(line)}); }

std::vector<std::size_t> TextTable::widths() const {
  std::vector<std::size_t> widths;
  for (const Column& column : columns_) {
    widths.push_back(std::max(column.title.size(), column.above.size()));
  }
  for (const Row& row : rows_) {
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      widths[c] = std::max(widths[c], row.cells[c].size());
    }
  }
  return widths;
}

std::string TextTable::text() const {
  const auto width = widths();
  const auto line = [&](const auto& cell) {
    std::string text;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      text += c == 0 ? "" : std::string(gap_, ' ');
      text += columns_[c].left ? fmt::format("{:<{}}", cell(c), width[c])
                               : fmt::format("{:>{}}", cell(c), width[c]);
    }
    return without_blanks_at_end(std::move(text));
  };
  const bool two_lines = std::any_of(columns_.begin(), columns_.end(),
                                     [](const Column& column) { return !column.above.empty(); });
  std::string text;
  if (two_lines) text += line([&](std::size_t c) { return columns_[c].above; });
  text += line([&](std::size_t c) { return columns_[c].title; });
  for (const Row& row : rows_) {
    text += row.cells.empty() ? without_blanks_at_end(row.line)
                              : line([&](std::size_t c) { return row.cells[c]; });
  }
  return text;
}

std::string spaced(std::span<const std::string> parts) {
  std::string text;
  std::size_t length = 0;  // of the last line
  for (const std::string& part : parts) {
    const bool fits = length + 3 + part.size() <= kLineWidth;
    if (!text.empty()) text += fits ? "   " : "\n";
    length = text.empty() || !fits ? part.size() : length + 3 + part.size();
    text += part;
  }
  return text + "\n";
}

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
  if (s.stiffness > 0) add("spring_stiffness", s.stiffness);
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

std::string run_table(const Request& request, const run::Outcome& outcome, const RunTimes& times) {
  std::string text = scene_text(request.scene) + "\n" + results_table(outcome.results);
  if (outcome.simulation) text += "errors are half widths of 95 % confidence intervals\n";
  text += elsewhere(request, outcome);
  if (outcome.comparison) text += comparison_table(*outcome.comparison, request.files.compared);
  text += "\n" + cost_table(outcome);
  text += verdict_on_accuracy(request.question, outcome);
  text += fmt::format("{:.2f} s in total, {:.2f} s of it start-up\n", times.total, times.start_up);
  if (outcome.next_digit_seconds > 0) {
    text += fmt::format("one more digit would take about {:.2g} s\n", outcome.next_digit_seconds);
  }
  return text;
}

std::string count_text(double count) { return count > 0 ? fmt::format("{:.2e}", count) : "-"; }

std::vector<TextTable::Cell> size_cells(const run::Resolution& r, std::int64_t unknowns,
                                        std::int64_t nonzeros) {
  std::vector<TextTable::Cell> cells;
  const auto add = [&cells](TextTable::Column column, auto value) {
    cells.emplace_back(std::move(column), fmt::format("{}", value));
  };
  if (r.scheme == cases::Scheme::hp) add({"degree"}, r.degree);
  if (r.scheme == cases::Scheme::hp) add({"layers"}, r.layers);
  if (r.scheme == cases::Scheme::upwind) add({"p"}, r.points);
  add({"levels", false, "noise"}, r.levels);
  add({"nodes", false, "noise"}, r.noise_nodes());
  if (r.scheme == cases::Scheme::none) return cells;
  add({"v_max"}, fmt::format("{:.4g}", r.v_max));
  add({"unknowns"}, unknowns);
  add({"nonzeros"}, count_text(static_cast<double>(nonzeros)));
  return cells;
}

}  // namespace stickslip::cli
