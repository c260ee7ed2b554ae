#include "stickslip/cli/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <petscsys.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "reading.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/cli/output.hpp"
#include "stickslip/cli/reports.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/linalg/solver_statistics.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/run/campaign.hpp"
#include "stickslip/run/carry_out.hpp"

namespace stickslip::cli {
namespace {

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
  for (const auto* output : all()) {
    const auto& of = output->subjects;
    const bool of_runs = of.contains(Subject::run) && !of.contains(Subject::sweep);
    if (of_runs) refuse(output->option, of_one_run, leave);
  }
  const auto asked = asked_quantities(settings);
  for (const auto& word : asked) {
    const auto* entry = cases::find_entry(word);
    if (entry == nullptr || !entry->of_one_run) continue;
    settings.refuse(
        "quantities",
        fmt::format("asks for {}, a field or a path, which a sweep does not write", word),
        "run the points of interest one by one");
  }
}

void check_ranks(Settings& settings) {
  const int ranks = linalg::ranks(PETSC_COMM_WORLD);
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
  return std::ranges::find(axes, name, &SweepAxis::option) != axes.end();
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
  for (const auto& option : linalg::given_solver_options()) identity.push_back(option);
  return identity;
}

/// A number that all ranks count up, each value given once.
///
/// Lives in the memory of rank 0, which takes no part when others count (one-sided MPI). Not to be
/// copied; construction and destruction are collective. When it dies while an exception unwinds,
/// the window is left to MPI_Abort, since the other ranks would never join.
class SharedCounter {
 public:
  explicit SharedCounter(MPI_Comm comm) {
    if (linalg::ranks(comm) == 1) return;
    const MPI_Aint size = linalg::rank(comm) == 0 ? sizeof(long) : 0;
    MPI_Win_allocate(size, sizeof(long), MPI_INFO_NULL, comm, static_cast<void*>(&value_),
                     &window_);
    MPI_Win_lock_all(0, window_);
    if (size > 0) *value_ = 0;
    MPI_Win_sync(window_);
    MPI_Barrier(comm);
  }
  ~SharedCounter() {
    if (window_ == MPI_WIN_NULL || std::uncaught_exceptions() > 0) return;
    MPI_Win_unlock_all(window_);
    MPI_Win_free(&window_);
  }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  /// 0, 1, 2, ...: the value before it is counted up. Not collective.
  [[nodiscard]] long next() {
    if (window_ == MPI_WIN_NULL) return alone_++;
    const long one = 1;
    long before = 0;
    MPI_Fetch_and_op(&one, &before, MPI_LONG, 0, 0, MPI_SUM, window_);
    MPI_Win_flush(0, window_);
    return before;
  }

 private:
  MPI_Win window_ = MPI_WIN_NULL;  // none on one rank
  long* value_ = nullptr;          // of rank 0
  long alone_ = 0;
};

// In the order of Status.
constexpr const char* kStatuses[] = {"reached", "not reached", "failed", "no memory", "refused"};

Status status_named(const std::string& text) {
  const auto found = std::ranges::find(kStatuses, text);
  if (found == std::end(kStatuses)) throw std::invalid_argument("no status of a run: " + text);
  return static_cast<Status>(found - std::begin(kStatuses));
}

Json head(std::size_t point, Status status, const std::string& message) {
  Json json{{"point", point}, {"status", status_text(status)}};
  if (!message.empty()) json["message"] = message;
  return json;
}

Json outcome_of(MPI_Comm comm, const cases::Case& given, std::size_t point) {
  const double start = linalg::wall_seconds();
  try {
    const auto outcome = run::carry_out(comm, given, {});
    Json json =
        head(point, outcome.reached ? Status::reached : Status::not_reached, outcome.shortfall);
    json.update(run_json(given, outcome, {0, linalg::wall_seconds() - start}));
    return json;
  } catch (...) {
    const Failure failure = linalg::failure_in_flight();
    const bool memory = failure.status() == ExitStatus::no_memory;
    Json json = head(point, memory ? Status::no_memory : Status::failed, failure.what());
    json["scene"] = scene_json(given.scene);
    json["results"] = Json::object();
    json["cost"]["seconds"] = linalg::wall_seconds() - start;
    return json;
  }
}

// Computes a point on its own; failures of solvers and of memory become its status. Collective.
// Throws what is no stickslip::Failure.
SweepPoint compute_run(MPI_Comm comm, const Request& given, std::size_t point) {
  Json json = outcome_of(comm, given, point);
  json["warnings"] = given.warnings;
  return read_run(json.dump());
}

// A point at which the model cannot be computed.
SweepPoint refused_run(std::size_t point, const std::string& reason) {
  Json json = head(point, Status::refused, reason);
  json["scene"] = json["results"] = Json::object();
  json["cost"]["seconds"] = 0;
  return read_run(json.dump());
}

constexpr int kTag = 7;           // of the only messages between single ranks
constexpr double kPatience = 60;  // seconds between ranks that fail alike

/// Ranks that share a point; those that are too few for a group have none.
class RankGroup {
 public:
  RankGroup(MPI_Comm all, int ranks) : ranks_(ranks) {
    const int number = linalg::rank(all) / ranks;
    const bool complete = (number + 1) * ranks <= linalg::ranks(all);
    MPI_Comm_split(all, complete ? number : MPI_UNDEFINED, 0, &comm_);
  }
  ~RankGroup() {
    if (comm_ != MPI_COMM_NULL && std::uncaught_exceptions() == 0) MPI_Comm_free(&comm_);
  }
  RankGroup(const RankGroup&) = delete;
  RankGroup& operator=(const RankGroup&) = delete;

  [[nodiscard]] bool works() const { return comm_ != MPI_COMM_NULL; }
  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] bool leads() const { return works() && linalg::rank(comm_) == 0; }
  /// The number that the first rank of the group has.
  [[nodiscard]] long shared(long value) const {
    if (ranks_ > 1) MPI_Bcast(&value, 1, MPI_LONG, 0, comm_);
    return value;
  }
  /// Ends a point. A rank that fails where the others do not would wait for them, and they for it,
  /// for ever: it throws after kPatience, which ends all ranks.
  void end_alike(const SweepPoint& run) const {
    if (ranks_ == 1) return;
    const bool failed = run.status == Status::failed || run.status == Status::no_memory;
    std::array<int, 2> extremes{failed ? 1 : 0, failed ? -1 : 0};
    MPI_Request all = MPI_REQUEST_NULL;
    MPI_Iallreduce(MPI_IN_PLACE, extremes.data(), 2, MPI_INT, MPI_MAX, comm_, &all);
    const double start = linalg::wall_seconds();
    bool alone = false;
    for (int done = 0; done == 0 && !alone;) {
      MPI_Test(&all, &done, MPI_STATUS_IGNORE);
      if (done == 0 && failed) usleep(1000);
      alone = done == 0 && failed && linalg::wall_seconds() - start > kPatience;
    }
    // Alone, there is nothing to wait for. NOLINTNEXTLINE(clang-analyzer-optin.mpi.MPI-Checker)
    if (!alone && extremes[0] == -extremes[1]) return;
    throw std::runtime_error(
        fmt::format("point {}: one rank failed alone; {}", run.point, run.message));
  }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  int ranks_;
};

// Everything that may change a number: options, and the program.
run::Identity identity_of(MPI_Comm comm, const Sweep& sweep) {
  run::Identity identity;
  for (const auto& [name, value] : provenance(comm)) {
    const bool counts = name == "program" || name == "commit" || name == "scalar";
    if (counts) identity.emplace_back(name, value);
  }
  for (const auto& [name, value] : sweep.identity()) identity.emplace_back("-" + name, value);
  return identity;
}

/// The work of one rank.
class Worker {
 public:
  Worker(MPI_Comm comm, const Request& request, const SweepProgress& progress)
      : comm_(comm), request_(request), sweep_(*request.sweep), progress_(progress) {
    const auto& file = request.files.checkpoint;
    if (file.empty()) return;
    checkpoint_.emplace(file, run::CheckpointKind::sweep, identity_of(comm, sweep_));
  }

  SweepResult run() {
    load();
    compute();
    return gather();
  }

 private:
  [[nodiscard]] bool first_rank() const { return linalg::rank(comm_) == 0; }

  // What the checkpoint holds, to rank 0, and to all what is left to do.
  void load() {
    std::vector<char> finished(sweep_.size(), 0);
    if (checkpoint_) {
      checkpoint_->open(comm_, [&](const std::string& entry) {
        SweepPoint run = read_run(entry);
        finished.at(run.point) = run.status == Status::no_memory ? 0 : 1;
        if (finished[run.point] != 0) resumed_.push_back(std::move(run));
      });
    }
    for (const auto& [point, reason] : sweep_.left_out()) finished[point] = 1;
    MPI_Bcast(finished.data(), static_cast<int>(finished.size()), MPI_CHAR, 0, comm_);
    for (std::size_t point = 0; point < finished.size(); ++point) {
      if (finished[point] == 0) open_.push_back(point);
    }
  }

  void compute() {
    const RankGroup group(comm_, request_.sweep_ranks);
    SharedCounter taken(comm_), done(comm_);
    start_ = linalg::wall_seconds();
    while (group.works()) {
      const auto n = static_cast<std::size_t>(group.shared(group.leads() ? taken.next() : 0));
      if (n >= open_.size()) break;
      const std::size_t point = open_[n];
      const SweepPoint run = compute_run(group.comm(), sweep_.request(point), point);
      group.end_alike(run);
      if (group.leads()) finish(run, done);
    }
    MPI_Barrier(comm_);  // the counters live until all are through
  }

  void finish(const SweepPoint& run, SharedCounter& done) {
    lines_.push_back(run.entry);
    if (checkpoint_) checkpoint_->append(run.entry);
    const auto here = static_cast<std::size_t>(done.next()) + 1;
    if (!progress_) return;
    const auto all = sweep_.size(), open = open_.size();
    const double pace = (linalg::wall_seconds() - start_) / static_cast<double>(here);
    progress_({.point = run.point,
               .done = all - open + here,
               .count = all,
               .seconds_left = pace * static_cast<double>(open - here),
               .status = status_text(run.status),
               .seconds_of_point = run.seconds});
  }

  // All runs to rank 0, in the order of the points.
  SweepResult gather() {
    SweepResult all;
    if (!first_rank()) {
      send_lines();
      return all;
    }
    all.runs.resize(sweep_.size());
    for (auto& run : resumed_) all.runs[run.point] = std::move(run);
    const auto add = [&all](const std::string& line) {
      SweepPoint run = read_run(line);
      all.runs[run.point] = std::move(run);
    };
    for (const auto& line : lines_) add(line);
    for (std::size_t n = lines_.size(); n < open_.size(); ++n) add(receive_line());
    for (const auto& [point, reason] : sweep_.left_out()) {
      all.runs[point] = refused_run(point, reason);
    }
    all.resumed = sweep_.size() - open_.size() - sweep_.left_out().size();
    return all;
  }

  void send_lines() const {
    for (const auto& line : lines_) {
      MPI_Send(line.data(), static_cast<int>(line.size()), MPI_CHAR, 0, kTag, comm_);
    }
  }

  [[nodiscard]] std::string receive_line() const {
    MPI_Status status;
    int size = 0;
    MPI_Probe(MPI_ANY_SOURCE, kTag, comm_, &status);
    MPI_Get_count(&status, MPI_CHAR, &size);
    std::string line(static_cast<std::size_t>(size), ' ');
    MPI_Recv(line.data(), size, MPI_CHAR, status.MPI_SOURCE, kTag, comm_, MPI_STATUS_IGNORE);
    return line;
  }

  MPI_Comm comm_;
  const Request& request_;
  const Sweep& sweep_;
  const SweepProgress& progress_;
  std::optional<run::Checkpoint> checkpoint_;
  std::vector<SweepPoint> resumed_;  // of the checkpoint, on rank 0
  std::vector<std::size_t> open_;    // points left to do, on all ranks
  std::vector<std::string> lines_;   // finished here
  double start_ = 0;
};

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
  return std::ranges::any_of(all_options(), [&settings](const Option& option) {
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

const char* status_text(Status status) { return kStatuses[static_cast<std::size_t>(status)]; }

SweepPoint read_run(std::string entry) {
  const Json json = Json::parse(entry);
  SweepPoint run;
  const Json& point = json.at("point");
  if (!point.is_number_unsigned()) throw std::invalid_argument("no number of a point");
  run.point = point.get<std::size_t>();
  run.status = status_named(json.at("status").get<std::string>());
  run.message = json.value("message", "");
  run.results = results_of(json.at("results"));
  (void)json.at("scene");
  run.seconds = json.at("cost").at("seconds").get<double>();
  run.entry = std::move(entry);
  return run;
}

SweepResult run_sweep(MPI_Comm comm, const Request& request, const SweepProgress& progress) {
  return Worker(comm, request, progress).run();
}

int exit_status(const std::vector<SweepPoint>& runs) {
  auto worst = ExitStatus::done;
  for (const auto& run : runs) {
    if (run.status == Status::no_memory) return static_cast<int>(ExitStatus::no_memory);
    if (run.status != Status::reached) worst = ExitStatus::not_reached;
  }
  return static_cast<int>(worst);
}

}  // namespace stickslip::cli
