#include "stickslip/monte_carlo/simulate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "simulated_results.hpp"
#include "stickslip/checkpoint/checkpoint.hpp"
#include "stickslip/effects/effect.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/simulation/sampler.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::monte_carlo {
namespace {

using cases::Case;
using quantities::Results;
using simulation::Tally;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr int kBatch = 256;  // excursions with one random stream
constexpr int kRound = 64;   // batches between merges
constexpr long kWhole = long{kRound} * kBatch;
constexpr double kSecondsBetweenFiles = 3, kSecondsBetweenReports = 1;

// What is tallied.
void add_followed(const Case& given, checkpoint::Identity& found) {
  const auto wanted = wanted_of(given.question, given.scene.meant());
  const auto add = [&](const char* name, const auto& values) {
    found.emplace_back(name, values.empty() ? "none" : fmt::format("{}", fmt::join(values, ",")));
  };
  std::vector<std::string> followed, observables;
  for (const auto& [name, whether] : {std::pair{"moments", wanted.moments},
                                      {"noise_law", wanted.noise},
                                      {"spectrum or slip", wanted.displacement},
                                      {"laplace", !wanted.lambda.empty()},
                                      {"resolvent", !wanted.discount.empty()},
                                      {"duration_density", !wanted.edges.empty()},
                                      {"expectation", wanted.expectation},
                                      {"displacement", wanted.travel},
                                      {"autocorrelation", wanted.autocorrelation}}) {
    if (whether) followed.emplace_back(name);
  }
  for (const auto& f : wanted.observables) observables.push_back(f.name);
  add("-quantities", followed);
  add("-observable", observables);
  add("-lambda", wanted.discount.empty() ? wanted.lambda : wanted.discount);
  add("-omega", wanted.omega);
  add("-time", wanted.edges.empty() ? wanted.time : given.question.time);
  add("-velocity", wanted.speeds);
  add("-inverse_distance", wanted.inverse_distance);
  add("-distance", wanted.path_edges.empty() ? wanted.path_edges : given.question.distance);
  if (const auto& start = wanted.start) {
    found.emplace_back(
        "-start", fmt::format("{} {} {}", static_cast<int>(start->kind), start->level, start->v));
  }
}

// What fixes the numbers of a simulation, but for how many excursions there are: as understood, not
// as written, since questions may come from the file of -compare.
checkpoint::Identity identity(const Case& given) {
  const auto text = [](const auto& value) { return fmt::format("{}", value); };
  const auto& s = given.scene;
  checkpoint::Identity found;
  for (const auto& [name, value] : effects::parameters_of(s)) {
    // Of a file its levels count, wherever it is; nothing truncates a simulated velocity.
    if (name == "noise_file" || name == "speed_limit") continue;
    found.emplace_back("-" + name, std::visit(text, value));
  }
  found.emplace_back("-noise_levels", s.noise_levels ? text(*s.noise_levels) : "");
  if (const auto& table = s.noise.table) {
    std::string levels;
    for (int i = table->lowest(); i <= table->highest(); ++i) {
      const auto& [x, up, down] = table->at(i);
      levels += fmt::format("{},{},{};", x, up, down);
    }
    found.emplace_back("levels", std::move(levels));
  }
  found.emplace_back("-seed", text(given.method.seed));
  add_followed(given, found);
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
        wanted_(wanted_of(given.question, process_)),
        sampler_(process_, wanted_),
        tally_(sampler_.empty()) {
    if (file.empty()) return;
    checkpoint_.emplace(file, checkpoint::Kind::simulation, identity(given));
  }

  Simulated run() {
    require_time();
    load();
    const double all = given_.method.excursions;
    needed_ = all;
    while (!met() && done() < all) {
      const auto left = static_cast<long>(all - done());
      if (left < kWhole) {
        save(0);  // whole rounds, from which another run resumes
        round(left);
        return outcome();
      }
      round(kWhole);
      ++rounds_;
      save(kSecondsBetweenFiles);
      if (since(last_report_) > kSecondsBetweenReports) report(now());
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

  // Every sticking phase begins at most at the edge of the static levels, and a path lasts as long
  // as asked.
  void require_time() const {
    const auto chain = operators::StaticChain::of(process_);
    const auto sticking = chain.integral(std::vector<double>(chain.size(), 1.0));
    const double sides = process_.symmetric() ? 1 : 2,
                 stationary = wanted_.stationary_paths() ? sides : 0,
                 sticking_phases = sides + stationary + (wanted_.speeds.empty() ? 0 : 1),
                 walks = (wanted_.chosen_paths() ? 1 : 0) + stationary,
                 longest =
                     walks > 0 ? *std::max_element(wanted_.time.begin(), wanted_.time.end()) : 0;
    constexpr double jump = 15e-9, month = 30 * 86400.0;
    const double jumps =
        process_.noise.rate() *
        (sticking_phases * std::min(sticking.front(), sticking.back()) + walks * longest);
    const double seconds = given_.method.excursions * jumps * jump / petsc::ranks(comm_);
    if (seconds < month) return;
    throw BadInput(fmt::format(
        "-excursions = {:g}: a sample has {:.1e} jumps of the noise and more, so that this "
        "would take {:.0e} days; take fewer excursions{}, or -route excursion",
        given_.method.excursions, jumps, seconds / 86400, longest > 0 ? ", a shorter -time" : ""));
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
      const auto part = sampler_.batch(given_.method.seed, number, count);
      const auto packed = part.pack();
      own.insert(own.end(), packed.begin(), packed.end());
      if (!predicted_) predict(part);
    }
    merge(own, batches);
  }

  // The first batch shows how long it will take.
  void predict(const Tally& batch) {
    predicted_ = true;
    SimulationState s = now();
    s.excursions += batch.samples();
    s.jumps += batch.jumps();
    s.seconds_left = (s.wanted - s.excursions) / batch.samples() * s.seconds / petsc::ranks(comm_);
    report(s);
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
    Tally part = sampler_.empty();
    for (long b = 0; b < batches; ++b) {
      const double* packed = all.data() + starts[b % ranks] + b / ranks * size;
      part.unpack({packed, static_cast<std::size_t>(size)});
      tally_.merge(part);
    }
  }

  [[nodiscard]] Results results() const { return estimates(question_, process_, tally_); }

  [[nodiscard]] std::pair<double, std::string> worst(const Results& results) const {
    std::pair<double, std::string> worst{0, ""};
    for (const auto& result : results) {
      const double error = quantities::relative_error(result);
      if (!(error <= worst.first)) worst = {error, result.key};
    }
    return worst;
  }

  // Excursions that would meet the accuracy.
  [[nodiscard]] double needed(double error) const {
    return done() * std::pow(error / question_.accuracy, 2);
  }

  // Whether -accuracy is given and met.
  [[nodiscard]] bool met() {
    if (!question_.accuracy_given || done() == 0) return false;
    const double error = worst(results()).first;
    needed_ = std::clamp(needed(error), done(), given_.method.excursions);
    return error <= question_.accuracy;
  }

  void report(const SimulationState& state) {
    if (progress_ && first_rank()) progress_(state);
    last_report_ = Clock::now();
  }

  [[nodiscard]] SimulationState now() const {
    const double seconds = since(start_), here = done() - continued_from_;
    const double left = here > 0 ? seconds * std::max(0.0, needed_ - done()) / here : 0;
    return {done(), needed_, tally_.jumps() - jumps_before_, seconds, left};
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
                      error, needed(error));
    }
    return simulated;
  }

  MPI_Comm comm_;
  const Case& given_;
  const cases::Question& question_;
  const SimulationProgress& progress_;
  model::Process process_;
  simulation::Wanted wanted_;
  simulation::Sampler sampler_;
  Tally tally_;
  std::optional<checkpoint::Checkpoint> checkpoint_;
  double needed_ = 0;  // excursions, as far as known
  long rounds_ = 0;    // whole ones in the tally
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
