#include "stickslip/sweeps/report.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "stickslip/io/hdf5_file.hpp"
#include "stickslip/io/parts.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::sweeps {
namespace {

using io::Json;
using quantities::Result;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

const Result* find(const Run& run, const std::string& key) {
  for (const auto& result : run.results) {
    if (result.key == key) return &result;
  }
  return nullptr;
}

/// A result by its key, as the first run that has it shows it.
std::vector<const Result*> kinds_of_results(const std::vector<Run>& runs) {
  std::vector<const Result*> kinds;
  for (const auto& run : runs) {
    for (const auto& result : run.results) {
      const bool known = std::any_of(kinds.begin(), kinds.end(),
                                     [&](const Result* kind) { return kind->key == result.key; });
      if (!known) kinds.push_back(&result);
    }
  }
  return kinds;
}

std::vector<const Result*> kinds_of_scalars(const std::vector<Run>& runs) {
  auto kinds = kinds_of_results(runs);
  std::erase_if(kinds, [](const Result* kind) { return !kind->is_scalar(); });
  return kinds;
}

std::string cell(double value) { return std::isnan(value) ? "" : fmt::format("{:.17g}", value); }

// RFC 4180: what holds a comma stands in quotes.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  std::string inside;
  for (char c : text) inside += c == '"' ? "\"\"" : std::string(1, c);
  return "\"" + inside + "\"";
}

// The options of the scene that stay.
std::string fixed_options(const options::Request& request) {
  std::string text;
  for (const auto& option : options::table().front().options) {
    for (const auto& [name, value] : request.resolved) {
      if (name != option.name || value.empty() || value == "swept") continue;
      text += fmt::format("{}{} = {}", text.empty() ? "" : "   ", name, value);
    }
  }
  return text + "\n";
}

std::string title(const options::Sweep& sweep) {
  std::vector<std::string> axes;
  for (const auto& axis : sweep.axes()) {
    axes.push_back(fmt::format("{} ({} values)", axis.option, axis.values.size()));
  }
  return fmt::format("sweep of {}: {} points\n", enumerate(axes, "and"), sweep.size());
}

// Of the column of an axis.
std::size_t width(const options::SweepAxis& axis) {
  return std::max<std::size_t>(11, axis.option.size() + 2);
}

std::string scalar_cells(const Run& run, const std::string& key) {
  const Result* result = find(run, key);
  if (result == nullptr) return fmt::format("  {:>17} {:>8}", "", "");
  return fmt::format("  {:>17.10g} {:>8.1e}", result->value[0], result->error[0]);
}

std::string row(const options::Sweep& sweep, const Run& run,
                std::span<const Result* const> scalars) {
  std::string text;
  const auto values = sweep.values(run.point);
  for (std::size_t a = 0; a < values.size(); ++a) {
    text += fmt::format("{:>{}.6g}", values[a], width(sweep.axes()[a]));
  }
  for (const Result* scalar : scalars) text += scalar_cells(run, scalar->key);
  if (run.status != Status::reached) text += fmt::format("  {}", status_text(run.status));
  return text + "\n";
}

// Some scalars of all points; an empty line where the last but one axis moves on.
std::string block(const options::Sweep& sweep, const std::vector<Run>& runs,
                  std::span<const Result* const> scalars) {
  std::string text = "\n";
  for (const auto& axis : sweep.axes()) text += fmt::format("{:>{}}", axis.option, width(axis));
  for (const Result* scalar : scalars) text += fmt::format("  {:>17} {:>8}", scalar->key, "error");
  text += "\n";
  const std::size_t fastest = sweep.axes().back().values.size();
  for (const auto& run : runs) {
    const bool moves_on = sweep.axes().size() > 1 && run.point > 0 && run.point % fastest == 0;
    if (moves_on) text += "\n";
    text += row(sweep, run, scalars);
  }
  return text;
}

std::string shortfalls(const options::Sweep& sweep, const std::vector<Run>& runs) {
  constexpr int most = 10;  // the files hold all
  std::string text;
  int count = 0;
  for (const auto& run : runs) {
    if (run.status == Status::reached || ++count > most) continue;
    text +=
        fmt::format("{}: {}: {}\n", sweep.place(run.point), status_text(run.status), run.message);
  }
  return count > most ? text + fmt::format("and {} more like these\n", count - most) : text;
}

std::string counts(const Conducted& conducted, const io::RunTimes& times) {
  const auto reached = std::count_if(conducted.runs.begin(), conducted.runs.end(),
                                     [](const Run& run) { return run.status == Status::reached; });
  std::string text =
      fmt::format("{} of {} points reached the accuracy; ", reached, conducted.runs.size());
  if (conducted.resumed > 0) text += fmt::format("{} from the record; ", conducted.resumed);
  return text +
         fmt::format("{:.2f} s in all, {:.2f} s of it start-up\n", times.total, times.start_up);
}

/// Results of all points as arrays over the axes of the sweep, the last index within a result.
class Grid {
 public:
  Grid(io::Hdf5File& file, const options::Sweep& sweep, const std::vector<Run>& runs)
      : file_(file), runs_(runs) {
    for (const auto& axis : sweep.axes()) sizes_.push_back(axis.values.size());
  }

  void write_axes(const options::Sweep& sweep) {
    std::string names;
    for (const auto& axis : sweep.axes()) {
      file_.write_array("/sweep/" + axis.option, axis.values);
      if (!axis.unit.empty()) file_.attribute("/sweep/" + axis.option, "unit", axis.unit);
      names += (names.empty() ? "" : ",") + axis.option;
    }
    file_.attribute("/sweep", "axes", names);
  }

  void write_result(const Result& kind) {
    const std::string path = "/sweep/" + io::hdf5_name(kind.key);
    std::size_t length = 0;
    for (const auto& run : runs_) {
      const Result* result = find(run, kind.key);
      if (result != nullptr) length = std::max(length, result->value.size());
    }
    const auto write = [&](const std::string& name, auto values) {
      write_numbers(name, kind, length, values);
    };
    write(path, [](const Result& r) { return r.value; });
    write(path + "_error", [](const Result& r) { return r.error; });
    if (!kind.ci95.empty()) {
      write(path + "_low", [](const Result& r) { return ends(r, true); });
      write(path + "_high", [](const Result& r) { return ends(r, false); });
    }
    if (!kind.unit.empty()) file_.attribute(path, "unit", kind.unit);
    if (kind.is_scalar()) return;
    file_.attribute(path, "abscissa", kind.abscissa_name);
    write(path + "_" + kind.abscissa_name, [](const Result& r) { return r.abscissa; });
  }

  void write_numbers_of_runs(const std::string& name, const std::function<double(const Run&)>& of) {
    std::vector<double> values;
    for (const auto& run : runs_) values.push_back(of(run));
    file_.write_array(name, sizes_, values);
  }

 private:
  static std::vector<double> ends(const Result& result, bool low) {
    std::vector<double> values;
    for (const auto& pair : result.ci95) values.push_back(low ? pair.first : pair.second);
    return values;
  }

  // Arrays may differ in length from point to point, as the levels at which slides end do; NaN
  // where there is nothing.
  template <class Values>
  void write_numbers(const std::string& path, const Result& kind, std::size_t length,
                     Values values_of) {
    std::vector<double> all;
    for (const auto& run : runs_) {
      const Result* result = find(run, kind.key);
      std::vector<double> values = result == nullptr ? std::vector<double>{} : values_of(*result);
      values.resize(length, kNone);
      all.insert(all.end(), values.begin(), values.end());
    }
    auto sizes = sizes_;
    if (!kind.is_scalar()) sizes.push_back(length);
    file_.write_array(path, sizes, all);
  }

  io::Hdf5File& file_;
  const std::vector<Run>& runs_;
  std::vector<std::size_t> sizes_;
};

}  // namespace

std::string sweep_table(const options::Request& request, const Conducted& conducted,
                        const io::RunTimes& times) {
  const auto& sweep = *request.sweep;
  std::string text = title(sweep) + fixed_options(request);
  const auto kinds = kinds_of_scalars(conducted.runs);
  constexpr std::size_t side_by_side = 4;
  const std::size_t blocks =
      std::max<std::size_t>(1, (kinds.size() + side_by_side - 1) / side_by_side);
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t first = kinds.size() * b / blocks, end = kinds.size() * (b + 1) / blocks;
    text += block(sweep, conducted.runs, {kinds.data() + first, end - first});
  }
  text += "\n";
  for (const Result* kind : kinds_of_results(conducted.runs)) {
    if (kind->is_scalar()) continue;
    text += fmt::format("{} by {}: in the files of -summary and -output\n", kind->key,
                        kind->abscissa_name);
  }
  return text + shortfalls(sweep, conducted.runs) + counts(conducted, times);
}

std::string sweep_csv(const options::Request& request, const Conducted& conducted) {
  const auto& sweep = *request.sweep;
  const auto kinds = kinds_of_scalars(conducted.runs);
  std::string text;
  for (const auto& axis : sweep.axes()) text += axis.option + ",";
  for (const Result* kind : kinds) {
    text += quoted(kind->key) + "," + quoted(kind->key + "_error") + ",";
  }
  text += "status\n";
  for (const auto& run : conducted.runs) {
    for (double value : sweep.values(run.point)) text += cell(value) + ",";
    for (const Result* kind : kinds) {
      const Result* result = find(run, kind->key);
      text +=
          result == nullptr ? ",," : cell(result->value[0]) + "," + cell(result->error[0]) + ",";
    }
    text += std::string(status_text(run.status)) + "\n";
  }
  return text;
}

std::string sweep_summary(MPI_Comm comm, const options::Request& request,
                          const Conducted& conducted, const io::RunTimes& times) {
  Json json;
  for (const auto& axis : request.sweep->axes()) json["sweep"]["axes"][axis.option] = axis.values;
  json["sweep"]["points"] = conducted.runs.size();
  json["sweep"]["from_record"] = conducted.resumed;
  json["runs"] = Json::array();
  for (const auto& run : conducted.runs) json["runs"].push_back(Json::parse(run.entry));
  json["cost"] = {{"seconds", times.total}, {"start_up_seconds", times.start_up}};
  json["provenance"] = io::provenance_json(comm, request);
  return json.dump(2) + "\n";
}

void write_sweep_hdf5(MPI_Comm comm, const options::Request& request, const Conducted& conducted,
                      const io::RunTimes& times) {
  io::Hdf5File file(PETSC_COMM_SELF, request.output.output);
  file.make_group("/sweep");
  Grid grid(file, *request.sweep, conducted.runs);
  grid.write_axes(*request.sweep);
  for (const Result* kind : kinds_of_results(conducted.runs)) grid.write_result(*kind);
  grid.write_numbers_of_runs("/sweep/status",
                             [](const Run& run) { return static_cast<double>(run.status); });
  file.attribute("/sweep/status", "meaning", "0 reached, 1 not reached, 2 failed, 3 no memory");
  grid.write_numbers_of_runs("/sweep/seconds", [](const Run& run) { return run.seconds; });
  io::write_record(file, comm, request, times);
  file.commit();
}

}  // namespace stickslip::sweeps
