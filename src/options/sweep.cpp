#include "stickslip/options/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <petscsys.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <utility>

#include "reading.hpp"
#include "stickslip/effects/read_scene.hpp"
#include "stickslip/outputs/output.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/solver_options.hpp"

namespace stickslip::options {
namespace {

using outputs::Subject;

constexpr double kMostPoints = 100000;
constexpr const char* kSwept = "swept";   // in the place of a value, in the options as used
constexpr std::size_t kMostMessages = 8;  // of the points

std::vector<SweepAxis> read_axes(Settings& settings) {
  std::vector<SweepAxis> axes;
  for (const auto& option : all_options()) {
    const Option* swept = swept_by(option);
    if (swept == nullptr || !settings.has(option.name)) continue;
    axes.push_back({swept->name, swept->unit, settings.numbers(option.name)});
    auto sorted = axes.back().values;
    std::sort(sorted.begin(), sorted.end());
    const auto repeated = std::adjacent_find(sorted.begin(), sorted.end());
    if (repeated == sorted.end()) continue;
    settings.refuse(option.name, fmt::format("names {:g} twice", *repeated), "name it once");
  }
  return axes;
}

void check_size(const std::vector<SweepAxis>& axes, Problems& problems) {
  double points = 1;
  for (const auto& axis : axes) points *= static_cast<double>(axis.values.size());
  if (points <= kMostPoints) return;
  problems.add(fmt::format("-sweep_{}: makes {:.0f} points in all, and at most {:.0f} are allowed; "
                           "take fewer values, or several sweeps",
                           axes.back().option, points, kMostPoints));
}

// What is about one run alone, or makes a series of its own.
void check_alone(Settings& settings) {
  const auto refuse = [&](const std::string& name, const char* why, const char* fix) {
    const bool used = settings.has(name) && settings.text(name) != find(name)->initial;
    if (used) settings.refuse(name, why, fix);
  };
  constexpr const char* leave = "leave it out, or the -sweep_ options";
  refuse("study", "makes a series of runs of its own", leave);
  refuse("plan", "predicts one run, not a sweep", "leave the -sweep_ options out to predict a run");
  constexpr const char* of_one_run = "is a file for one run, not for a sweep";
  refuse("compare", of_one_run, leave);
  for (const auto* output : outputs::all()) {
    const auto& of = output->subjects;
    const bool of_runs = of.contains(Subject::run) && !of.contains(Subject::sweep);
    if (of_runs) refuse(output->option, of_one_run, leave);
  }
  const auto asked = asked_quantities(settings);
  for (const auto& word : asked) {
    const auto* entry = catalogue::find_entry(word);
    if (entry == nullptr || !entry->of_one_run) continue;
    settings.refuse(
        "quantities",
        fmt::format("asks for {}, a field or a path, which a sweep does not write", word),
        "run the points of interest one by one");
  }
}

void check_ranks(Settings& settings) {
  const int ranks = petsc::ranks(PETSC_COMM_WORLD);
  if (settings.integer("sweep_ranks").value_or(1) <= ranks) return;
  settings.refuse("sweep_ranks", fmt::format("is more than the {} of this run", ranks),
                  "take fewer, or start more with mpiexec -n");
}

// A swept option without effect would give the same results at all points.
void check_effects(const Sweep& sweep, const Request& request, Problems& problems) {
  for (const auto& axis : sweep.axes()) {
    for (const auto& warning : request.warnings) {
      if (!warning.starts_with(fmt::format("-{} = ", axis.option))) continue;
      problems.add(fmt::format("-sweep_{}: {}", axis.option, warning));
    }
  }
}

// A message without its numbers.
std::string kind_of(std::string message) {
  std::erase_if(message, [](char c) { return std::strchr("0123456789.+-e", c) != nullptr; });
  return message;
}

/// Messages about points, each once with the places it holds at, in the order in which they came
/// up. Those of one kind count as one.
class Messages {
 public:
  void add(const std::string& message, std::size_t point, const std::string& kind) {
    auto& points = points_of_[kind];
    if (points.empty()) order_.emplace_back(kind, message);
    points.push_back(point);
  }
  /// "at mu_d = 2 and 3 more points: " and the message; the message alone where these are all of
  /// so many points.
  [[nodiscard]] std::vector<std::string> texts(const Sweep& sweep, std::size_t all) const {
    std::vector<std::string> texts;
    for (const auto& [kind, message] : order_) {
      const auto& points = points_of_.at(kind);
      const std::string more =
          points.size() > 1 ? fmt::format(" and {} more points", points.size() - 1) : "";
      texts.push_back(points.size() == all
                          ? message
                          : fmt::format("at {}{}: {}", sweep.place(points.front()), more, message));
    }
    return texts;
  }

 private:
  std::map<std::string, std::vector<std::size_t>> points_of_;
  std::vector<std::pair<std::string, std::string>> order_;  // kind, first message
};

// Of many the first.
void report(const std::vector<std::string>& reasons, Problems& problems) {
  for (std::size_t n = 0; n < std::min(reasons.size(), kMostMessages); ++n)
    problems.add(reasons[n]);
  if (reasons.size() <= kMostMessages) return;
  problems.add(fmt::format("and {} more problems of this kind", reasons.size() - kMostMessages));
}

// Finds the points that the model refuses, which is a problem if it refuses all of them; returns
// the warnings about the others.
std::vector<std::string> check_points(Sweep& sweep, Problems& problems) {
  Messages refusals, notes;
  bool examined = false;
  for (std::size_t point = 0; point < sweep.size(); ++point) {
    Settings own = sweep.settings(point);
    const Request request = own.sound() ? request_of(own) : Request();
    const auto& messages = own.problems().messages();
    for (const auto& message : messages) refusals.add(message, point, message);
    if (!messages.empty()) {
      sweep.leave_out(point, fmt::format("{}", fmt::join(messages, "; ")));
      continue;
    }
    if (!std::exchange(examined, true)) check_effects(sweep, request, problems);
    for (const auto& said : request.warnings) notes.add(said, point, kind_of(said));
  }
  const auto refused = sweep.left_out().size();
  auto warnings = notes.texts(sweep, sweep.size() - refused);
  if (refused == 0) return warnings;
  const auto reasons = refusals.texts(sweep, sweep.size());
  if (!examined) report(reasons, problems);
  warnings.push_back(fmt::format("{} of {} points are refused and left out, such as {}", refused,
                                 sweep.size(), reasons.front()));
  return warnings;
}

bool is_axis(const std::vector<SweepAxis>& axes, const std::string& name) {
  return std::any_of(axes.begin(), axes.end(),
                     [&name](const SweepAxis& axis) { return axis.option == name; });
}

// Options of the output change no number, and the checkpoint is the file that holds this.
std::vector<std::pair<std::string, std::string>> identity_of(const Settings& settings,
                                                             const std::vector<SweepAxis>& axes) {
  std::vector<std::pair<std::string, std::string>> identity;
  for (const auto& group : table()) {
    if (group.title == "Output") continue;
    for (const auto& option : group.options) {
      if (option.name == "checkpoint" || option.name == "plan") continue;
      const bool swept = is_axis(axes, option.name);
      identity.emplace_back(option.name, swept ? kSwept : settings.text(option.name));
      if (option.kind != Kind::input || !settings.has(option.name)) continue;
      std::ostringstream contents;
      contents << std::ifstream(identity.back().second).rdbuf();
      identity.back().second = contents.str();
    }
  }
  for (const auto& option : petsc::given_solver_options()) identity.push_back(option);
  return identity;
}

}  // namespace

Sweep::Sweep(Settings settings, std::vector<SweepAxis> axes)
    : settings_(std::move(settings)),
      axes_(std::move(axes)),
      identity_(identity_of(settings_, axes_)) {}

std::size_t Sweep::size() const {
  std::size_t points = 1;
  for (const auto& axis : axes_) points *= axis.values.size();
  return points;
}

std::vector<double> Sweep::values(std::size_t point) const {
  std::vector<double> values(axes_.size());
  for (std::size_t a = axes_.size(); a-- > 0;) {
    const auto& all = axes_[a].values;
    values[a] = all[point % all.size()];
    point /= all.size();
  }
  return values;
}

std::string Sweep::place(std::size_t point) const {
  const auto at = values(point);
  std::string text;
  for (std::size_t a = 0; a < at.size(); ++a) {
    text += fmt::format("{}{} = {:g}", a == 0 ? "" : ", ", axes_[a].option, at[a]);
  }
  return text;
}

Settings Sweep::settings(std::size_t point) const {
  Settings settings = settings_;
  const auto at = values(point);
  for (std::size_t a = 0; a < at.size(); ++a) settings.set(axes_[a].option, at[a]);
  return settings;
}

Request Sweep::request(std::size_t point) const {
  Settings of_point = settings(point);
  Request request = request_of(of_point);
  request.files = {};
  return request;
}

bool sweeps(const Settings& settings) {
  const auto options = all_options();
  return std::any_of(options.begin(), options.end(), [&settings](const Option& option) {
    return swept_by(option) != nullptr && settings.has(option.name);
  });
}

Request read_sweep(Settings settings) {
  Problems& problems = settings.problems();
  auto axes = read_axes(settings);
  check_size(axes, problems);
  check_alone(settings);
  check_ranks(settings);
  problems.raise();
  const auto sweep = std::make_shared<Sweep>(settings, std::move(axes));
  auto warnings = check_points(*sweep, problems);
  problems.raise();
  std::size_t first = 0;
  while (sweep->left_out().contains(first)) ++first;
  Request request = sweep->request(first);
  request.warnings = std::move(warnings);
  request.sweep = sweep;
  request.files = read_files(settings);
  for (auto& [name, value] : request.resolved) {
    if (is_axis(sweep->axes(), name)) value = kSwept;
    if (name == "mu_d" && !settings.has(name) && is_axis(sweep->axes(), "mu_s")) value.clear();
  }
  return request;
}

}  // namespace stickslip::options
