#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "stickslip/base/text.hpp"
#include "stickslip/cli/reports.hpp"

namespace stickslip::cli {
namespace {

using quantities::Result;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kShown = 8, kWritten = 100;  // numbers of an array in table and CSV file

/// Numbers of one result at all points: a column of tables and CSV, a dataset of HDF5.
struct Column {
  const Result* result;  // of the first point that has it
  std::string name;      // its key, with _error, _low, _high or its abscissa behind it
  std::vector<std::vector<double>> at;  // by point: one number of a scalar; none where it lacks
  std::size_t place = 0;                // of the number that a table has, in arrays

  [[nodiscard]] bool is_values() const { return name == result->key; }
  [[nodiscard]] double number(const SweepPoint& run) const {
    return at[run.point].size() > place ? at[run.point][place] : kNone;
  }
};

/// Columns of all results, the values of each followed by its errors.
std::vector<Column> columns_of(const std::vector<SweepPoint>& runs) {
  std::vector<Column> columns;
  std::size_t points = 0;
  for (const auto& run : runs) points = std::max(points, run.point + 1);
  const auto put = [&](const SweepPoint& run, const Result& r, const std::string& part,
                       auto values) {
    const std::string name = r.key + part;
    auto found = std::ranges::find(columns, name, &Column::name);
    if (found == columns.end()) {
      found = columns.insert(found, {&r, name, std::vector<std::vector<double>>(points)});
    }
    found->at[run.point] = std::move(values);
  };
  for (const auto& run : runs) {
    for (const auto& r : run.results) {
      put(run, r, "", r.value);
      put(run, r, "_error", r.error);
      if (!r.is_scalar()) put(run, r, "_" + r.abscissa_name, r.abscissa);
      if (r.ci95.empty()) continue;
      std::vector<double> low, high;
      for (const auto& interval : r.ci95) {
        low.push_back(interval.first);
        high.push_back(interval.second);
      }
      put(run, r, "_low", std::move(low));
      put(run, r, "_high", std::move(high));
    }
  }
  return columns;
}

/// Whether an array has numbers for the values of an option, such as -distance, and how many.
bool is_listed(const Request& request, const Result& r, std::size_t most) {
  return !r.is_scalar() && r.value.size() <= most &&
         std::ranges::any_of(request.resolved, [&](const auto& option) {
           return option.first == r.abscissa_name && !option.second.empty();
         });
}

/// Values and errors of scalars, one after the other, and of arrays that have a number for each of
/// at most so many values of an option: "displacement_cdf(10)[0.1]".
std::vector<Column> numbers_of(const Request& request, const std::vector<SweepPoint>& runs,
                               std::size_t most) {
  const auto columns = columns_of(runs);
  std::vector<Column> numbers;
  for (std::size_t n = 0; n + 1 < columns.size(); ++n) {
    if (!columns[n].is_values()) continue;
    const Result& r = *columns[n].result;
    const bool listed = is_listed(request, r, most);
    const std::size_t count = listed ? r.value.size() : r.is_scalar() ? 1 : 0;
    for (std::size_t place = 0; place < count; ++place) {
      for (Column column : {columns[n], columns[n + 1]}) {
        column.place = place;
        if (listed) column.name.insert(r.key.size(), fmt::format("[{:.12g}]", r.abscissa[place]));
        numbers.push_back(std::move(column));
      }
    }
  }
  return numbers;
}

// The model parameters that are not swept.
std::string fixed_options(const Request& request) {
  std::vector<std::string> parts;
  for (const auto& option : table().front().options) {
    for (const auto& [name, value] : request.resolved) {
      if (name != option.name || value.empty() || value == "swept") continue;
      parts.push_back(fmt::format("{} = {}", name, value));
    }
  }
  return spaced(parts);
}

std::string title(const Sweep& sweep) {
  std::vector<std::string> axes;
  for (const auto& axis : sweep.axes()) {
    axes.push_back(fmt::format("{} ({} values)", axis.option, axis.values.size()));
  }
  return fmt::format("sweep of {}: {} points\n", enumerate(axes, "and"), sweep.size());
}

/// The columns of a scalar: its values, and their errors.
using Pair = std::array<Column, 2>;

std::vector<std::string> row_cells(const Sweep& sweep, const SweepPoint& run,
                                   std::span<const Pair> scalars) {
  std::vector<std::string> cells;
  for (double value : sweep.values(run.point)) cells.push_back(fmt::format("{:.6g}", value));
  for (const auto& [values, errors] : scalars) {
    const double value = values.number(run), error = errors.number(run);
    cells.push_back(std::isnan(value) ? "" : number_text(value, error));
    cells.push_back(std::isnan(value) ? "" : error_text(error));
  }
  if (run.status != Status::reached) cells.emplace_back(status_text(run.status));
  return cells;
}

// Some scalars of all points; an empty line where the last but one axis moves on.
std::string block(const Sweep& sweep, const std::vector<SweepPoint>& runs,
                  std::span<const Pair> scalars) {
  std::vector<TextTable::Column> titles;
  for (const auto& axis : sweep.axes()) titles.push_back({axis.option});
  for (const auto& scalar : scalars) {
    titles.push_back({scalar[0].name});
    titles.push_back({"error"});
  }
  titles.push_back({"", true});  // status
  TextTable table(std::move(titles));
  const std::size_t fastest = sweep.axes().back().values.size();
  for (const auto& run : runs) {
    const bool moves_on = sweep.axes().size() > 1 && run.point > 0 && run.point % fastest == 0;
    if (moves_on) table.add_line("");
    table.add(row_cells(sweep, run, scalars));
  }
  return table.text();
}

std::size_t longest_line(const std::string& text) {
  std::size_t longest = 0;
  for (const auto& line : split(text, '\n')) longest = std::max(longest, line.size());
  return longest;
}

// As many scalars side by side as lines have room for.
std::string blocks(const Request& request, const std::vector<SweepPoint>& runs) {
  const auto& sweep = *request.sweep;
  std::vector<Pair> pairs;
  const auto columns = numbers_of(request, runs, kShown);
  for (std::size_t n = 0; n + 1 < columns.size(); n += 2) {
    pairs.push_back({columns[n], columns[n + 1]});
  }
  std::span<const Pair> left(pairs);
  std::string text;
  do {
    std::size_t count = std::min<std::size_t>(1, left.size());
    std::string best = block(sweep, runs, left.first(count));
    for (; count < left.size(); ++count) {
      std::string wider = block(sweep, runs, left.first(count + 1));
      if (longest_line(wider) > kLineWidth) break;
      best = std::move(wider);
    }
    text += "\n" + best;
    left = left.subspan(count);
  } while (!left.empty());
  return text;
}

std::string shortfalls(const Sweep& sweep, const std::vector<SweepPoint>& runs) {
  constexpr int most = 10;  // the files hold all
  std::string text;
  int count = 0;
  for (const auto& run : runs) {
    if (run.status == Status::reached || ++count > most) continue;
    text += wrap(fmt::format("{}: {}: {}", sweep.place(run.point), status_text(run.status),
                             run.message),
                 kLineWidth - 2, 2) +
            "\n";
  }
  return count > most ? text + fmt::format("and {} more like these\n", count - most) : text;
}

std::string counts(const SweepResult& result, const RunTimes& times) {
  const auto reached = std::ranges::count(result.runs, Status::reached, &SweepPoint::status);
  std::string text =
      fmt::format("{} of {} points reached the accuracy; ", reached, result.runs.size());
  if (result.resumed > 0) text += fmt::format("{} from the checkpoint; ", result.resumed);
  return text +
         fmt::format("{:.2f} s in total, {:.2f} s of it start-up\n", times.total, times.start_up);
}

std::string text_of(const Request& request, const SweepResult& result, const RunTimes& times) {
  const auto& sweep = *request.sweep;
  std::string text = title(sweep) + fixed_options(request) + blocks(request, result.runs) + "\n";
  for (const auto& column : columns_of(result.runs)) {
    const Result& r = *column.result;
    if (r.is_scalar() || !column.is_values() || is_listed(request, r, kShown)) continue;
    text += fmt::format("{} by {}: in the files of -summary and -output\n", column.name,
                        r.abscissa_name);
  }
  return text + shortfalls(sweep, result.runs) + counts(result, times);
}

Json tree_of(const Request& request, const SweepResult& result, const RunTimes& times) {
  Json tree;
  for (const auto& axis : request.sweep->axes()) tree["sweep"]["axes"][axis.option] = axis.values;
  tree["sweep"]["points"] = result.runs.size();
  tree["sweep"]["from_record"] = result.resumed;
  tree["runs"] = Json::array();
  for (const auto& run : result.runs) tree["runs"].push_back(Json::parse(run.entry));
  tree["cost"] = {{"seconds", times.total}, {"start_up_seconds", times.start_up}};
  return tree;
}

std::vector<std::vector<std::string>> rows_of(const Request& request,
                                              const std::vector<SweepPoint>& runs) {
  const auto& sweep = *request.sweep;
  const auto scalars = numbers_of(request, runs, kWritten);
  std::vector<std::vector<std::string>> rows(1);
  for (const auto& axis : sweep.axes()) rows[0].push_back(axis.option);
  for (const auto& scalar : scalars) rows[0].push_back(scalar.name);
  rows[0].emplace_back("status");
  for (const auto& run : runs) {
    auto& cells = rows.emplace_back();
    for (double value : sweep.values(run.point)) cells.push_back(cell(value, 17));
    for (const auto& scalar : scalars) cells.push_back(cell(scalar.number(run), 17));
    cells.emplace_back(status_text(run.status));
  }
  return rows;
}

// What a result is over at each point, if that is the same at all of them, or its beginning where a
// point has less of it, as fewer slips; else nothing.
std::vector<double> shared_abscissa(const std::vector<std::vector<double>>& at) {
  const auto& longest = *std::ranges::max_element(at, {}, &std::vector<double>::size);
  const bool shared = std::ranges::all_of(at, [&](const auto& numbers) {
    return std::equal(numbers.begin(), numbers.end(), longest.begin());
  });
  return shared ? longest : std::vector<double>{};
}

// The name of the array of a grid that labels the last index of results over such numbers, which is
// added if it is missing; empty where the points differ in them.
std::string inner_axis(Grid& grid, const std::string& name, const std::vector<double>& numbers) {
  if (numbers.empty()) return "";
  for (int n = 1;; ++n) {
    std::string own = n == 1 ? name : fmt::format("{}_{}", name, n);
    const auto found = std::ranges::find(grid.arrays, own, &Array::name);
    if (found == grid.arrays.end()) {
      grid.arrays.push_back({own, {numbers.size()}, numbers, {}, {own}});
      return own;
    }
    if (found->axes == std::vector{own} && found->values == numbers) return own;
  }
}

// The last index is within a result. Arrays may differ in length from point to point, as the levels
// at which sliding phases end do; NaN where there is nothing.
Array array_of(const Column& column, std::vector<std::size_t> sizes,
               std::vector<std::string> axes) {
  const Result& r = *column.result;
  Array array{column.name, std::move(sizes), {}, {}, std::move(axes)};
  std::size_t length = 0;
  for (const auto& numbers : column.at) length = std::max(length, numbers.size());
  for (auto numbers : column.at) {
    numbers.resize(length, kNone);
    array.values.insert(array.values.end(), numbers.begin(), numbers.end());
  }
  if (!r.is_scalar()) array.sizes.push_back(length);
  if (column.is_values() && !r.unit.empty()) array.notes.emplace_back("unit", r.unit);
  if (column.is_values() && !r.is_scalar()) array.notes.emplace_back("abscissa", r.abscissa_name);
  return array;
}

Grid grid_of(const Sweep& sweep, const std::vector<SweepPoint>& runs) {
  Grid grid;
  std::vector<std::size_t> sizes;
  std::vector<std::string> axes;
  for (const auto& axis : sweep.axes()) {
    sizes.push_back(axis.values.size());
    axes.push_back(axis.option);
    grid.arrays.push_back({axis.option, {axis.values.size()}, axis.values, {}, {axis.option}});
    if (!axis.unit.empty()) grid.arrays.back().notes.emplace_back("unit", axis.unit);
  }
  grid.notes.emplace_back("axes", fmt::format("{}", fmt::join(axes, ",")));
  const auto columns = columns_of(runs);
  for (const auto& column : columns) {
    const Result& r = *column.result;
    auto own = axes;
    if (!r.is_scalar()) {
      const auto over = std::ranges::find(columns, r.key + "_" + r.abscissa_name, &Column::name);
      own.push_back(inner_axis(grid, r.abscissa_name, shared_abscissa(over->at)));
    }
    grid.arrays.push_back(array_of(column, sizes, own));
  }
  std::vector<double> status, seconds;
  for (const auto& run : runs) {
    status.push_back(static_cast<double>(run.status));
    seconds.push_back(run.seconds);
  }
  grid.arrays.push_back(
      {"status",
       sizes,
       status,
       {{"meaning", "0 reached, 1 not reached, 2 failed, 3 no memory, 4 refused"}},
       axes});
  grid.arrays.push_back({"seconds", sizes, seconds, {}, axes});
  return grid;
}

}  // namespace

Report report_of(MPI_Comm comm, const Request& request, const SweepResult& sweep,
                 const RunTimes& times) {
  auto report = report_from(comm, request, Subject::sweep, times);
  report.comm = MPI_COMM_SELF;
  report.text = text_of(request, sweep, times);
  report.tree = [&request, &sweep, times] { return tree_of(request, sweep, times); };
  report.rows = [&request, &sweep] { return rows_of(request, sweep.runs); };
  report.grid = [&request, &sweep] { return grid_of(*request.sweep, sweep.runs); };
  return report;
}

}  // namespace stickslip::cli
