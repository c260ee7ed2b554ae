#include "stickslip/run/campaign.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>

#include "stickslip/base/errors.hpp"
#include "stickslip/base/files.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::run {
namespace {

using cases::Case;
using cases::Kind;
using quantities::Results;
using simulation::Tally;

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "stickslip checkpoint 3";

/// A file open for reading and writing, locked against other processes that do the same.
class LockedFile {
 public:
  explicit LockedFile(const std::string& name)
      : name_(name), descriptor_(open(name.c_str(), O_RDWR | O_CREAT | O_APPEND, 0666)) {
    if (descriptor_ < 0) fail("cannot open");
    struct stat kind {};
    regular_ = fstat(descriptor_, &kind) == 0 && S_ISREG(kind.st_mode);
    if (!regular_) return;
    // Locks of this kind work over NFS; where there are none, O_APPEND has to do.
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    while (fcntl(descriptor_, F_SETLKW, &lock) != 0 && errno == EINTR) {
    }
  }
  ~LockedFile() { close(descriptor_); }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  [[nodiscard]] bool regular() const { return regular_; }
  [[nodiscard]] std::string read_all() const {
    std::string text;
    std::array<char, 65536> part{};
    for (ssize_t size = 0; (size = read(descriptor_, part.data(), part.size())) != 0;) {
      if (size < 0) fail("cannot read");
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

  void truncate(std::size_t size) const {
    if (ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail("cannot write");
  }

  // Whole or not at all: what a full disk has taken of it is removed.
  void append(const std::string& text) const {
    const off_t before = lseek(descriptor_, 0, SEEK_END);
    errno = 0;
    const ssize_t written = write(descriptor_, text.data(), text.size());
    if (written == static_cast<ssize_t>(text.size()) && fsync(descriptor_) == 0) return;
    const int reason = errno == 0 ? ENOSPC : errno;
    const bool removed = before >= 0 && ftruncate(descriptor_, before) == 0;
    errno = reason;
    fail(removed ? "cannot write" : "cannot write, nor remove the last line of,");
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw SystemFailure(fmt::format("{} {}: {}", what, name_, std::strerror(errno)));
  }

  std::string name_;
  int descriptor_;
  bool regular_ = false;
};

std::string name_of(CheckpointKind kind) {
  return kind == CheckpointKind::sweep ? "sweep" : "simulation";
}

std::string header_of(const std::string& kind, const Identity& identity) {
  Json json{{"format", kFormat}, {"of", kind}, {"run", Json::object()}};
  for (const auto& [name, value] : identity) json["run"][name] = value;
  return json.dump() + "\n";
}

// The order of options means nothing.
bool same(const std::string& header, const std::string& other) {
  return nlohmann::json::parse(header, nullptr, false) == nlohmann::json::parse(other);
}

using Clock = std::chrono::steady_clock;

constexpr int kBatch = 256;  // excursions with one random stream
constexpr int kRound = 64;   // batches between merges
constexpr long kWhole = long{kRound} * kBatch;
constexpr double kSecondsBetweenFiles = 3, kSecondsBetweenReports = 1;

// The quantities, and what else of the question they depend on.
void add_question(const cases::Question& question, Identity& found) {
  std::vector<std::string_view> words, observables;
  std::set<std::string> options;
  for (const auto* entry : cases::entries()) {
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
        {"start", fmt::format("{} {} {}{}", static_cast<int>(start.kind), start.level, start.v,
                              start.p ? fmt::format(" {} {}", start.x, *start.p) : "")}}) {
    if (options.contains(option)) found.emplace_back(fmt::format("-{}", option), value);
  }
  for (const auto* argument : cases::arguments()) {
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
Identity identity(const Case& given) {
  const auto text = [](const auto& value) { return fmt::format("{}", value); };
  const auto& s = given.scene;
  Identity found;
  for (const auto& [name, value] : effects::parameters_of(s)) {
    // Of files the levels count, wherever they are; nothing truncates a simulated velocity.
    if (is_file(name) || name == "speed_limit") continue;
    found.emplace_back("-" + name, std::visit(text, value));
  }
  found.emplace_back("-noise_levels", s.noise_levels ? text(*s.noise_levels) : "");
  if (const auto table = s.spring ? s.followed().noise.table : s.noise.table;
      table && !s.noise.gaussian) {
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
        process_(given.scene.followed()),
        sampler_(given.question, process_),
        tally_(given.question, process_) {
    if (file.empty()) return;
    checkpoint_.emplace(file, CheckpointKind::simulation, identity(given));
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
  [[nodiscard]] bool first_rank() const { return linalg::rank(comm_) == 0; }

  // Every sticking phase begins at most at the edge of the static levels, and a path lasts as long
  // as asked.
  void require_time() const {
    const auto& wanted = tally_.wanted();
    const double longest = wanted.time.empty() ? 0 : std::ranges::max(wanted.time),
                 jumps = simulation::follows_paths(process_) ? simulation::steps_of_sample(process_)
                                                             : jumps_of_sample(longest);
    constexpr double jump = 15e-9, month = 30 * 86400.0;
    const double seconds = given_.method.excursions * jumps * jump / linalg::ranks(comm_);
    if (seconds < month) return;
    throw BadInput(fmt::format(
        "-excursions = {:g}: a sample has {:.1e} jumps of the noise and more, so that this "
        "would take {:.0e} days; take fewer excursions{}, or -route excursion",
        given_.method.excursions, jumps, seconds / 86400, longest > 0 ? ", a shorter -time" : ""));
  }

  [[nodiscard]] double jumps_of_sample(double longest) const {
    const auto& wanted = tally_.wanted();
    const auto chain = generator::StaticChain::of(process_);
    const auto sticking = chain.integral(std::vector<double>(chain.size(), 1.0));
    const double sides = process_.symmetric() ? 1 : 2,
                 stationary = wanted.stationary_paths ? sides : 0,
                 sticking_phases = sides + stationary + (wanted.speeds.empty() ? 0 : 1),
                 walks = (wanted.start ? 1 : 0) + stationary;
    return process_.noise.rate() *
           (sticking_phases * std::min(sticking.front(), sticking.back()) + walks * longest);
  }

  void load() {
    if (!checkpoint_) return;
    std::string state;
    checkpoint_->open(comm_, [&](const std::string& entry) {
      restore(entry);
      state = entry;
    });
    state = linalg::first_text(comm_, state);
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
    const int ranks = linalg::ranks(comm_);
    std::vector<double> own;
    for (long b = linalg::rank(comm_); b < batches; b += ranks) {
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
    s.seconds_left = (s.wanted - s.excursions) / batch.samples() * s.seconds / linalg::ranks(comm_);
    report(s);
  }

  // Batches in their order, whoever made them; ranks with one less send room for another.
  void merge(std::vector<double> own, long batches) {
    const long size = static_cast<long>(tally_.size()), ranks = linalg::ranks(comm_),
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
    quantities::leave_out_uncountable(process_, all);
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
  std::optional<Checkpoint> checkpoint_;
  double needed_ = 0;  // excursions, as far as known
  long rounds_ = 0;    // whole ones in the tally
  double continued_from_ = 0, jumps_before_ = 0;
  bool predicted_ = false;
  Clock::time_point start_ = Clock::now(), last_report_ = start_, last_file_ = start_;
};

}  // namespace

Checkpoint::Checkpoint(std::string file, CheckpointKind kind, const Identity& identity)
    : file_(std::move(file)), kind_(name_of(kind)), header_(header_of(kind_, identity)) {}

void Checkpoint::refuse(const std::string& why) const {
  throw BadInput(fmt::format("-checkpoint = {}: {}; name another file, or remove it", file_, why));
}

// Reports in what the header of the file differs.
void Checkpoint::refuse_other(const std::string& header) const {
  const Json json = Json::parse(header, nullptr, false), own = Json::parse(header_);
  const auto agrees = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key] == own[key];
  };
  if (!agrees("format") || !agrees("of") || !json.contains("run") || !json["run"].is_object()) {
    refuse(fmt::format("is no checkpoint of a {} by this version of the program", kind_));
  }
  const auto refuse_difference = [&](const Json& names) {
    for (const auto& option : names.items()) {
      const auto found = json["run"].value(option.key(), Json("none"));
      const auto wanted = own["run"].value(option.key(), Json("none"));
      if (found == wanted) continue;
      refuse(fmt::format("belongs to a {} with {} {}, not {}", kind_, option.key(), found.dump(),
                         wanted.dump()));
    }
  };
  refuse_difference(own["run"]);
  refuse_difference(json["run"]);
  refuse("belongs to another version of the program");
}

void Checkpoint::open(MPI_Comm comm, const Take& take) const {
  std::string problem;
  if (linalg::rank(comm) == 0) {
    try {
      read(take);
    } catch (const BadInput& bad) {
      problem = bad.what();
    }
  }
  problem = linalg::first_text(comm, problem);
  if (!problem.empty()) throw BadInput(problem);
}

void Checkpoint::read(const Take& take) const {
  const LockedFile file(file_);
  if (!file.regular()) refuse("is no regular file");
  const std::string text = file.read_all();
  if (header_.starts_with(text)) {  // new, or killed before the first line was whole
    file.truncate(0);
    file.append(header_);
    return;
  }
  const std::string header = text.substr(0, text.find('\n') + 1);
  if (!same(header, header_)) refuse_other(header);
  const std::size_t whole = text.rfind('\n') + 1;
  std::vector<std::string> lines = split(text.substr(header.size(), whole - header.size()), '\n');
  if (!lines.empty()) lines.pop_back();  // behind the last end of line
  // A file that is always replaced as a whole is never truncated.
  if (kind_ == name_of(CheckpointKind::simulation) && (lines.size() > 1 || whole < text.size())) {
    refuse("is damaged");
  }
  for (const auto& line : lines) {
    const auto entry = unsealed(line);
    if (!entry) refuse("is damaged");
    try {
      take(*entry);
    } catch (const std::exception&) {
      refuse("is damaged");
    }
  }
  if (whole < text.size()) file.truncate(whole);
}

void Checkpoint::append(const std::string& entry) const {
  LockedFile(file_).append(sealed(entry) + "\n");
}

void Checkpoint::replace(const std::string& entry) const {
  write_text(file_, header_ + sealed(entry) + "\n");
}

Simulated simulate(MPI_Comm comm, const Case& given, const std::string& checkpoint,
                   const SimulationProgress& progress) {
  return Campaign(comm, given, checkpoint, progress).run();
}

}  // namespace stickslip::run
