#include "stickslip/monte_carlo/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "stickslip/checkpoint/checkpoint.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/simulation/tally.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::monte_carlo {
namespace {

using options::Case;
using options::Quantity;
using quantities::Kind;
using quantities::Result;
using quantities::Results;
using simulation::Duration;
using simulation::Estimate;
using simulation::Tally;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr int kBatch = 256;  // excursions with one random stream
constexpr int kRound = 64;   // batches between merges
constexpr double kSecondsBetweenFiles = 3, kSecondsBetweenReports = 1;

/// Cell of a histogram around one time of -time.
struct Cell {
  double low, high;
};

// Up to the middle between neighbours, and as far on the other side at the ends.
std::vector<Cell> cells_around(const std::vector<double>& time) {
  std::vector<double> sorted = time;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<Cell> cells;
  for (double t : time) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), t);
    const bool first = at == sorted.begin(), last = at + 1 == sorted.end();
    const double alone = t > 0 ? 0.05 * t : 1;
    const double up = last ? 0 : (*(at + 1) - t) / 2, down = first ? 0 : (t - *(at - 1)) / 2;
    const double above = last ? (first ? alone : down) : up;
    const double below = first ? (last ? alone : up) : down;
    cells.push_back({std::max(0.0, t - below), t + above});
  }
  return cells;
}

simulation::Wanted wanted_of(const Case& given) {
  simulation::Wanted wanted;
  const options::Question& question = given.question;
  wanted.moments = question.wants(Quantity::moments);
  wanted.noise = question.wants(Quantity::noise_law);
  wanted.cycles = !given.scene.symmetric();
  if (question.wants(Quantity::spectrum)) wanted.omega = question.omega;
  if (question.wants(Quantity::laplace)) wanted.lambda = question.lambda;
  if (!question.wants(Quantity::duration_density)) return wanted;
  auto& edges = wanted.edges;
  for (double t : question.time) edges.push_back(t);
  for (const Cell& cell : cells_around(question.time)) {
    edges.push_back(cell.low);
    edges.push_back(cell.high);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return wanted;
}

void append_value(Result& result, const Estimate& e) {
  result.value.push_back(e.value);
  result.error.push_back(std::max(e.high - e.value, e.value - e.low));
  result.ci95.emplace_back(e.low, e.high);
}

/// Turns a tally into results.
class Estimates {
 public:
  Estimates(const options::Question& question, const model::Process& process, const Tally& tally)
      : question_(question), process_(process), tally_(tally) {}

  Results all() {
    if (question_.wants(Quantity::sticking)) append_sticking();
    if (question_.wants(Quantity::moments)) append_moments();
    if (question_.wants(Quantity::noise_law)) {
      scalar(quantities::kPWithin, tally_.within());
      scalar(quantities::kEX2, tally_.noise_square());
    }
    if (question_.wants(Quantity::entry_law)) append_hitting_distribution();
    if (question_.wants(Quantity::laplace)) append_laplace();
    if (question_.wants(Quantity::duration_density)) append_durations();
    if (question_.wants(Quantity::spectrum)) append_spectrum();
    return std::move(results_);
  }

 private:
  void scalar(const quantities::Name& name, const Estimate& e) {
    Result result{name.key, name.unit, "", {}, {}, {}, name.kind};
    append_value(result, e);
    results_.push_back(std::move(result));
  }

  void append_sticking() {
    scalar(quantities::kPStick, tally_.sticking());
    scalar(quantities::kPSlide, tally_.sliding());
    scalar(quantities::kMeanStick, tally_.mean(Duration::stick));
    scalar(quantities::kMeanSlide, tally_.mean(Duration::slide));
    scalar(quantities::kMeanExcursion, tally_.mean(Duration::excursion));
  }

  void append_moments() {
    scalar(quantities::kEV2, tally_.mean_square());
    scalar(quantities::kEAbsV, tally_.mean_speed());
    scalar(quantities::kEXV, tally_.mean_product());
    if (process_.symmetric()) {
      results_.push_back(quantities::scalar(quantities::kEV, 0, 0));
    } else {
      scalar(quantities::kEV, tally_.mean_velocity());
    }
  }

  void append_hitting_distribution() {
    const int k = process_.static_index();
    Result law = quantities::array("entry_law", "", "k", {});
    for (int i = -k; i <= k; ++i) {
      law.abscissa.push_back(i);
      append_value(law, tally_.entry(i));
    }
    results_.push_back(std::move(law));
    scalar(quantities::kFStick0,
           tally_.entry_of_both(-k, k, process_.noise.rate() * process_.noise.up(k)));
  }

  void append_laplace() {
    for (const auto& [key, duration] : names("F_")) {
      Result result = quantities::array(key, "", "lambda", question_.lambda, Kind::transform);
      for (std::size_t n = 0; n < question_.lambda.size(); ++n) {
        append_value(result, tally_.laplace(n, duration));
      }
      results_.push_back(std::move(result));
    }
  }

  void append_durations() {
    const auto cells = cells_around(question_.time);
    for (const auto& [key, duration] : names("f_")) {
      Result density = quantities::array(key, "1/time", "time", question_.time);
      for (const auto& cell : cells) {
        const Estimate e = tally_.probability(duration, cell.low, cell.high);
        const double width = cell.high - cell.low;
        append_value(density, {e.value / width, e.low / width, e.high / width});
      }
      results_.push_back(std::move(density));
      Result distribution =
          quantities::array("cd" + key, "", "time", question_.time, Kind::distribution);
      for (double t : question_.time) {
        append_value(distribution, tally_.probability(duration, 0, t));
      }
      results_.push_back(std::move(distribution));
    }
  }

  void append_spectrum() {
    if (!process_.symmetric()) return append_spectrum_at_zero();
    Result s =
        quantities::array("S_v", "velocity^2*time", "omega", question_.omega, Kind::spectrum);
    for (std::size_t n = 0; n < question_.omega.size(); ++n) append_value(s, tally_.spectrum(n));
    results_.push_back(std::move(s));
  }

  void append_spectrum_at_zero() {
    const Estimate s = tally_.spectrum_at_zero();
    scalar(quantities::kS0, s);
    scalar(quantities::kDiffusivity, {s.value / 2, s.low / 2, s.high / 2});
  }

  static std::vector<std::pair<std::string, Duration>> names(const std::string& prefix) {
    return {{prefix + "slide", Duration::slide},
            {prefix + "stick", Duration::stick},
            {prefix + "excursion", Duration::excursion}};
  }

  const options::Question& question_;
  const model::Process& process_;
  const Tally& tally_;
  Results results_;
};

// What fixes the numbers of a simulation, but for how many excursions there are: as understood, not
// as written, since questions may come from the file of -compare.
checkpoint::Identity identity(const Case& given) {
  const auto text = [](auto value) { return fmt::format("{}", value); };
  const auto& s = given.scene;
  checkpoint::Identity found{{"-mu_s", text(s.friction.mu_s)},
                             {"-mu_d", text(s.friction.mu_d)},
                             {"-mu_s_minus", text(s.friction.mirrored().mu_s)},
                             {"-mu_d_minus", text(s.friction.mirrored().mu_d)},
                             {"-tau", text(s.tau)},
                             {"-delta", text(s.delta)},
                             {"-noise_levels", s.noise_levels ? text(*s.noise_levels) : ""},
                             {"-drag", s.drag_name},
                             {"-drag_coefficient", text(s.drag.linear)},
                             {"-drag_cubic", text(s.drag.cubic)}};
  if (s.drag.law) found.emplace_back("-drag_expression", s.drag_expression);
  found.emplace_back("-bias", text(s.bias));
  found.emplace_back("-seed", text(given.method.seed));
  const auto wanted = wanted_of(given);
  const auto add = [&](const char* name, const auto& values) {
    found.emplace_back(name, values.empty() ? "none" : fmt::format("{}", fmt::join(values, ",")));
  };
  std::vector<std::string> followed;
  if (wanted.moments) followed.emplace_back("moments");
  if (wanted.noise) followed.emplace_back("noise_law");
  add("-quantities", followed);
  add("-lambda", wanted.lambda);
  add("-omega", wanted.omega);
  add("-time", wanted.edges.empty() ? wanted.edges : given.question.time);
  return found;
}

class Campaign {
 public:
  Campaign(MPI_Comm comm, const Case& given, const std::string& file,
           const SimulationProgress& progress)
      : comm_(comm),
        given_(given),
        question_(given.question),
        progress_(progress),
        process_(given.scene.meant()),
        wanted_(wanted_of(given)),
        source_(simulation::make_source(process_, wanted_)),
        tally_(wanted_, process_.static_index()) {
    if (file.empty()) return;
    checkpoint_.emplace(file, checkpoint::Kind::simulation, identity(given));
  }

  Simulated run() {
    require_time();
    load();
    const double all = given_.method.excursions;
    state_.wanted = all;
    while (!met() && done() < all) {
      const auto left = static_cast<long>(all - done());
      const bool whole = left >= static_cast<long>(kRound) * kBatch;
      if (!whole) {
        save(0);  // whole rounds, from which another run resumes
        round(left);
        return outcome();
      }
      round(static_cast<long>(kRound) * kBatch);
      ++rounds_;
      save(kSecondsBetweenFiles);
      if (since(last_report_) > kSecondsBetweenReports) report();
    }
    save(0);
    return outcome();
  }

 private:
  [[nodiscard]] double done() const { return tally_.samples(); }
  [[nodiscard]] static double since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }
  [[nodiscard]] bool first_rank() const { return petsc::rank(comm_) == 0; }

  // Every stay begins at most at the edge of the static levels.
  void require_time() const {
    const auto chain = operators::StaticChain::of(process_);
    const auto sticking = chain.integral(std::vector<double>(chain.size(), 1.0));
    constexpr double jump = 15e-9, month = 30 * 86400.0;
    const double jumps = process_.noise.rate() * std::min(sticking.front(), sticking.back());
    const double seconds = given_.method.excursions * jumps * jump / petsc::ranks(comm_);
    if (seconds < month) return;
    throw BadInput(fmt::format(
        "-excursions = {:g}: bodies stick for {:.1e} jumps of the noise and more, so that this "
        "would take {:.0e} days; take fewer excursions, or -route excursion",
        given_.method.excursions, jumps, seconds / 86400));
  }

  void load() {
    if (!checkpoint_) return;
    std::string state;
    checkpoint_->open(comm_, [&](const std::string& entry) {
      restore(entry);
      state = entry;
    });
    state = petsc::first_text(comm_, state);
    if (!state.empty()) restore(state);
    continued_from_ = done();
    jumps_before_ = tally_.jumps();
  }

  void restore(const std::string& state) {
    const Json json = Json::parse(state);
    const Json& rounds = json.at("rounds");
    tally_.unpack(json.at("tally").get<std::vector<double>>());
    if (!rounds.is_number_integer() || done() != rounds.get<double>() * kRound * kBatch) {
      throw std::invalid_argument("rounds and excursions of the tally differ");
    }
    rounds_ = rounds.get<long>();
  }

  void save(double seconds_between) {
    if (!checkpoint_ || !first_rank() || since(last_file_) < seconds_between) return;
    checkpoint_->replace(Json{{"rounds", rounds_}, {"tally", tally_.pack()}}.dump());
    last_file_ = Clock::now();
  }

  // Simulates `excursions` more, from the batch on that follows the whole rounds.
  void round(long excursions) {
    const long batches = (excursions + kBatch - 1) / kBatch;
    const int ranks = petsc::ranks(comm_);
    std::vector<double> own;
    for (long b = petsc::rank(comm_); b < batches; b += ranks) {
      const auto count = static_cast<int>(std::min<long>(kBatch, excursions - b * kBatch));
      const auto number = static_cast<std::uint64_t>(rounds_ * kRound + b);
      const auto part = simulation::simulate_batch(*source_, wanted_, process_.static_index(),
                                                   given_.method.seed, number, count);
      const auto packed = part.pack();
      own.insert(own.end(), packed.begin(), packed.end());
      if (!predicted_) predict(part);
    }
    merge(own, batches);
  }

  // The first batch tells how long it will take.
  void predict(const Tally& batch) {
    predicted_ = true;
    state_.excursions = done() + batch.samples();
    state_.jumps = tally_.jumps() + batch.jumps();
    state_.seconds = since(start_);
    state_.seconds_left = (state_.wanted - state_.excursions) / batch.samples() * state_.seconds /
                          petsc::ranks(comm_);
    if (progress_ && first_rank()) progress_(state_);
    last_report_ = Clock::now();
  }

  // Batches in their order, whoever made them.
  void merge(const std::vector<double>& own, long batches) {
    const int ranks = petsc::ranks(comm_);
    const auto size = static_cast<long>(tally_.packed_size());
    std::vector<int> counts, starts;
    int total = 0;
    for (int r = 0; r < ranks; ++r) {
      const long share = batches > r ? (batches - r + ranks - 1) / ranks : 0;
      starts.push_back(total);
      counts.push_back(static_cast<int>(share * size));
      total += counts.back();
    }
    std::vector<double> all(static_cast<std::size_t>(total));
    MPI_Allgatherv(own.data(), static_cast<int>(own.size()), MPI_DOUBLE, all.data(), counts.data(),
                   starts.data(), MPI_DOUBLE, comm_);
    Tally part(wanted_, process_.static_index());
    for (long b = 0; b < batches; ++b) {
      const double* packed = all.data() + starts[b % ranks] + b / ranks * size;
      part.unpack({packed, static_cast<std::size_t>(size)});
      tally_.merge(part);
    }
  }

  [[nodiscard]] Results results() const { return Estimates(question_, process_, tally_).all(); }

  [[nodiscard]] std::pair<double, std::string> worst(const Results& results) const {
    std::pair<double, std::string> worst{0, ""};
    for (const auto& result : results) {
      const double error = quantities::relative_error(result);
      if (!(error <= worst.first)) worst = {error, result.key};
    }
    return worst;
  }

  // Whether -accuracy is given and met.
  [[nodiscard]] bool met() {
    if (!question_.accuracy_given || done() == 0) return false;
    const double error = worst(results()).first;
    const double needed = done() * std::pow(error / question_.accuracy, 2);
    state_.wanted = std::clamp(needed, done(), given_.method.excursions);
    return error <= question_.accuracy;
  }

  void report() {
    if (!progress_ || !first_rank()) return;
    progress_(now());
    last_report_ = Clock::now();
  }

  [[nodiscard]] SimulationState now() const {
    SimulationState s = state_;
    s.excursions = done();
    s.jumps = tally_.jumps() - jumps_before_;
    s.seconds = since(start_);
    const double here = done() - continued_from_;
    s.seconds_left = here > 0 ? s.seconds * std::max(0.0, s.wanted - done()) / here : 0;
    return s;
  }

  Simulated outcome() {
    Simulated simulated;
    simulated.results = results();
    const auto [error, key] = worst(simulated.results);
    simulated.reached = !question_.accuracy_given || error <= question_.accuracy;
    simulated.state = now();
    simulated.continued_from = continued_from_;
    if (!simulated.reached) {
      simulated.shortfall =
          fmt::format("the interval of {} is +-{:.1e}; it would take about -excursions {:.0e}", key,
                      error, done() * std::pow(error / question_.accuracy, 2));
    }
    return simulated;
  }

  MPI_Comm comm_;
  const Case& given_;
  const options::Question& question_;
  const SimulationProgress& progress_;
  model::Process process_;
  simulation::Wanted wanted_;
  std::unique_ptr<simulation::ExcursionSource> source_;
  Tally tally_;
  std::optional<checkpoint::Checkpoint> checkpoint_;
  SimulationState state_;
  long rounds_ = 0;  // whole ones in the tally
  double continued_from_ = 0, jumps_before_ = 0;
  bool predicted_ = false;
  Clock::time_point start_ = Clock::now(), last_report_ = start_, last_file_ = start_;
};

}  // namespace

Simulated simulate(MPI_Comm comm, const Case& given, const std::string& checkpoint,
                   const SimulationProgress& progress) {
  return Campaign(comm, given, checkpoint, progress).run();
}

}  // namespace stickslip::monte_carlo
