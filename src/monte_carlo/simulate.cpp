#include "stickslip/monte_carlo/simulate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "stickslip/checkpoint/checkpoint.hpp"
#include "stickslip/effects/effect.hpp"
#include "stickslip/effects/model_options.hpp"
#include "stickslip/operators/static_chain.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/simulation/sampler.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::monte_carlo {
namespace {

using cases::Case;
using catalogue::Kind;
using quantities::Results;
using simulation::Tally;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr int kBatch = 256;  // excursions with one random stream
constexpr int kRound = 64;   // batches between merges
constexpr long kWhole = long{kRound} * kBatch;
constexpr double kSecondsBetweenFiles = 3, kSecondsBetweenReports = 1;

// The quantities, and what else of the question they depend on.
void add_question(const cases::Question& question, checkpoint::Identity& found) {
  std::vector<std::string_view> words, observables;
  std::set<std::string> options;
  for (const auto* entry : catalogue::entries()) {
    if (!question.wants(entry->quantity) || entry->of_one_run) continue;
    words.push_back(entry->word);
    for (auto& option : entry->all_options()) options.insert(std::move(option));
  }
  for (const auto& f : question.observables) observables.emplace_back(f.name);
  const auto& start = question.start;
  const auto text = [](const auto& values) { return fmt::format("{}", fmt::join(values, ",")); };
  found.emplace_back("-quantities", text(words));
  for (const auto& [option, value] :
       {std::pair{"observable", text(observables)},
        {"passage", fmt::format("{}", static_cast<int>(question.passage))},
        {"start", fmt::format("{} {} {}", static_cast<int>(start.kind), start.level, start.v)}}) {
    if (options.contains(option)) found.emplace_back(fmt::format("-{}", option), value);
  }
  for (const auto* argument : catalogue::arguments()) {
    const std::string option(argument->option);
    if (options.contains(option)) found.emplace_back("-" + option, text(question.values(option)));
  }
}

bool is_file(const std::string& parameter) {
  const auto& all = effects::model_options();
  return std::ranges::any_of(all, [&](const effects::Option& option) {
    return option.name == parameter && option.kind == effects::Kind::input;
  });
}

// What fixes the numbers of a simulation, but for how many excursions there are: as understood, not
// as written, since questions may come from the file of -compare.
checkpoint::Identity identity(const Case& given) {
  const auto text = [](const auto& value) { return fmt::format("{}", value); };
  const auto& s = given.scene;
  checkpoint::Identity found;
  for (const auto& [name, value] : effects::parameters_of(s)) {
    // Of files the levels count, wherever they are; nothing truncates a simulated velocity.
    if (is_file(name) || name == "speed_limit") continue;
    found.emplace_back("-" + name, std::visit(text, value));
  }
  found.emplace_back("-noise_levels", s.noise_levels ? text(*s.noise_levels) : "");
  if (const auto& table = s.noise.table) {
    std::string levels;
    for (int i = table->lowest(); i <= table->highest(); ++i) {
      levels += fmt::format("{}", table->at(i).x);
      table->for_each_jump(i,
                           [&](int to, double rate) { levels += fmt::format(",{},{}", to, rate); });
      levels += ";";
    }
    found.emplace_back("levels", std::move(levels));
  }
  found.emplace_back("-seed", text(given.method.seed));
  add_question(given.question, found);
  return found;
}

// What no sample met has no size of its own.
quantities::Result result_of(const simulation::Estimated& e) {
  auto result = e.observable ? quantities::blank(*e.row, *e.observable) : quantities::blank(*e.row);
  if (!e.key.empty()) result.key = e.key;
  result.abscissa = e.abscissa;
  const bool of_events = result.kind == Kind::probability || result.kind == Kind::other;
  if (of_events && !result.is_scalar()) result.each_by_its_size = false;
  for (const auto& [value, low, high] : e.values) {
    result.value.push_back(value);
    result.error.push_back(std::max(high - value, value - low));
    if (!e.exact) result.ci95.emplace_back(low, high);
  }
  return result;
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
        sampler_(given.question, process_),
        tally_(given.question, process_) {
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
    const auto& wanted = tally_.wanted();
    const auto chain = operators::StaticChain::of(process_);
    const auto sticking = chain.integral(std::vector<double>(chain.size(), 1.0));
    const double sides = process_.symmetric() ? 1 : 2,
                 stationary = wanted.stationary_paths ? sides : 0,
                 sticking_phases = sides + stationary + (wanted.speeds.empty() ? 0 : 1),
                 walks = (wanted.start ? 1 : 0) + stationary,
                 longest = wanted.time.empty() ? 0 : std::ranges::max(wanted.time);
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
    tally_.clear();
    tally_.merge(json.at("tally").get<std::vector<double>>());
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
      const Tally& part = sampler_.batch(given_.method.seed, number, count);
      const auto packed = part.pack();
      own.insert(own.end(), packed.begin(), packed.end());
      if (!predicted_) predict(part);
    }
    merge(std::move(own), batches);
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

  // Batches in their order, whoever made them; ranks with one less send room for another.
  void merge(std::vector<double> own, long batches) {
    const long size = static_cast<long>(tally_.size()), ranks = petsc::ranks(comm_),
               share = (batches + ranks - 1) / ranks * size;
    own.resize(static_cast<std::size_t>(share));
    std::vector<double> all(static_cast<std::size_t>(ranks * share));
    MPI_Allgather(own.data(), static_cast<int>(share), MPI_DOUBLE, all.data(),
                  static_cast<int>(share), MPI_DOUBLE, comm_);
    for (long b = 0; b < batches; ++b) {
      const double* packed = all.data() + b % ranks * share + b / ranks * size;
      tally_.merge({packed, static_cast<std::size_t>(size)});
    }
  }

  [[nodiscard]] Results results() const {
    Results all;
    std::ranges::transform(tally_.estimates(), std::back_inserter(all), result_of);
    quantities::leave_out_missing_side(process_, all);
    return all;
  }

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
