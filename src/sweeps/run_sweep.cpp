#include "stickslip/sweeps/run_sweep.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <exception>
#include <optional>
#include <string>

#include "shared_counter.hpp"
#include "stickslip/checkpoint/checkpoint.hpp"
#include "stickslip/io/provenance.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/solver_statistics.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::sweeps {
namespace {

using options::Request;

constexpr int kTag = 7;           // of the only messages between single ranks
constexpr double kPatience = 60;  // seconds between ranks that fail alike

/// Ranks that share a point; those that are too few for a group have none.
class Group {
 public:
  Group(MPI_Comm all, int ranks) : ranks_(ranks) {
    const int number = petsc::rank(all) / ranks;
    const bool complete = (number + 1) * ranks <= petsc::ranks(all);
    MPI_Comm_split(all, complete ? number : MPI_UNDEFINED, 0, &comm_);
  }
  ~Group() {
    if (comm_ != MPI_COMM_NULL && std::uncaught_exceptions() == 0) MPI_Comm_free(&comm_);
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  [[nodiscard]] bool works() const { return comm_ != MPI_COMM_NULL; }
  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] bool leads() const { return works() && petsc::rank(comm_) == 0; }
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
    const double start = petsc::wall_seconds();
    bool alone = false;
    for (int done = 0; done == 0 && !alone;) {
      MPI_Test(&all, &done, MPI_STATUS_IGNORE);
      if (done == 0 && failed) usleep(1000);
      alone = done == 0 && failed && petsc::wall_seconds() - start > kPatience;
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
checkpoint::Identity identity_of(MPI_Comm comm, const options::Sweep& sweep) {
  checkpoint::Identity identity;
  for (const auto& [name, value] : io::provenance(comm)) {
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
    checkpoint_.emplace(file, checkpoint::Kind::sweep, identity_of(comm, sweep_));
  }

  SweepResult run() {
    load();
    compute();
    return gather();
  }

 private:
  [[nodiscard]] bool first_rank() const { return petsc::rank(comm_) == 0; }

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
    const Group group(comm_, request_.sweep_ranks);
    SharedCounter taken(comm_), done(comm_);
    start_ = petsc::wall_seconds();
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
    State state;
    state.point = run.point;
    state.count = sweep_.size();
    state.done = state.count - open_.size() + here;
    state.seconds_left = (petsc::wall_seconds() - start_) *
                         static_cast<double>(open_.size() - here) / static_cast<double>(here);
    state.status = status_text(run.status);
    state.seconds_of_point = run.seconds;
    progress_(state);
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
  const options::Sweep& sweep_;
  const SweepProgress& progress_;
  std::optional<checkpoint::Checkpoint> checkpoint_;
  std::vector<SweepPoint> resumed_;  // of the checkpoint, on rank 0
  std::vector<std::size_t> open_;    // points left to do, on all ranks
  std::vector<std::string> lines_;   // finished here
  double start_ = 0;
};

}  // namespace

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

}  // namespace stickslip::sweeps
