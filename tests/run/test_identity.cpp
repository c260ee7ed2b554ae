#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "../common/catch.hpp"
#include "../common/options.hpp"
#include "../common/temporary.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/cli/options.hpp"
#include "stickslip/cli/request.hpp"
#include "stickslip/run/campaign.hpp"

using namespace stickslip;
using namespace stickslip::cli;

namespace {

using Options = std::map<std::string, std::string>;  // names without dash

// Options that a checkpoint may be continued with, whatever their values.
const std::set<std::string> kFree{
    "excursions",  // more of them extend a simulation
    "accuracy",    // ends it sooner
    "checkpoint",  // the file itself
    "plan",        // simulates nothing
    "horizon",     // of the trajectory, which is not tallied
    // What -route monte_carlo does not know, or takes no notice of:
    "route", "scheme", "degree", "layers", "noise_degree", "noise_grading", "p", "v_max",
    "speed_limit", "spectrum_solver", "tilt", "probability", "force_file", "force_interpolation",
    "force_scale", "force_rest", "sample_layout", "sample_step", "force_gravity", "covariance",
    "covariance_file", "spring_stiffness"};

// Options that change only along with others: each command line below has its own.
const std::set<std::string> kWithOthers{"friction", "noise"};

std::string all_simulated() {
  std::vector<std::string> words;
  for (const auto* entry : cases::entries()) {
    const bool simulated = entry->routes.contains(Route::monte_carlo);
    if (simulated && !entry->of_one_run) words.emplace_back(entry->word);
  }
  return fmt::format("{}", fmt::join(words, ","));
}

/// Files that noises take.
struct NoiseFiles {
  std::string levels, states, rates;
};

/// Command lines of which at least one takes each option of the table.
std::vector<Options> command_lines(const NoiseFiles& files) {
  const Options all{{"route", "monte_carlo"},
                    {"excursions", "300"},
                    {"quantities", all_simulated()},
                    {"observable", "v^2;stick"},
                    {"mu_d", "0.25"},
                    {"lambda", "0.5"},
                    {"omega", "1"},
                    {"time", "0.5,1"},
                    {"start", "0,0.3"},
                    {"distance", "0.5"},
                    {"inverse_distance", "0.5"},
                    {"wavenumber", "0.5"},
                    {"velocity", "0.5"}};
  std::vector<Options> lines(10, all);
  lines[0].insert({{"delta", "0.5"}});
  lines[1].insert({{"drag", "cubic"},
                   {"drag_cubic", "0.5"},
                   {"friction", "stribeck"},
                   {"stribeck_velocity", "0.3"},
                   {"bias", "0.1"}});
  lines[2].insert({{"drag", "expression"}, {"drag_expression", " -v"}});
  lines[3].insert({{"noise", "telegraph"},
                   {"telegraph_amplitude", "1"},
                   {"telegraph_rate", "1"},
                   {"bias", "0.3"}});
  lines[4].insert({{"noise", "file"}, {"noise_file", files.levels}});
  lines[5].insert(
      {{"noise", "chain"}, {"noise_states", files.states}, {"noise_rates", files.rates}});
  lines[6].insert({{"noise", "narrow_band"}, {"band_frequency", "2"}, {"band_width", "0.6"}});
  lines[7].insert({{"noise", "filtered"},
                   {"ground_frequency", "2"},
                   {"ground_damping", "0.5"},
                   {"ground_intensity", "1"}});
  for (int continuous : {6, 7}) lines[continuous]["quantities"] = "sticking,averages,slip";
  lines[8].insert({{"noise", "periodic"}, {"periodic_amplitude", "2"}, {"period", "4"}});
  lines[9].insert({{"noise", "pulses"},
                   {"pulse_height", "2"},
                   {"pulse_rate", "0.5"},
                   {"pulse_decay", "0.5"},
                   {"pulse_steps", "2"}});
  lines.push_back(lines[9]);
  lines[10].erase("pulse_decay");
  lines[10].erase("pulse_steps");
  lines[10]["pulse_duration"] = "0.5";
  for (std::size_t n = 3; n < lines.size(); ++n) lines[n]["start"] = "s+";
  return lines;
}

std::optional<Request> read(const Options& options) {
  std::vector<std::pair<std::string, std::string>> given;
  for (const auto& [name, value] : options) given.emplace_back("-" + name, value);
  const test::Given database(given);
  try {
    return read_request({});
  } catch (const BadInput&) {
    return std::nullopt;
  }
}

/// Other values of an option; the first that a command line takes is tried.
std::vector<std::string> others(const Option& option, const std::string& value,
                                const NoiseFiles& files) {
  const auto number = parse_number(value);
  switch (option.kind) {
  case Kind::real:
    if (number && *number != 0) return {fmt::format("{}", 1.1 * *number)};
    return {"0.7", "1.3", "0.3"};
  case Kind::integer:
    if (number) return {fmt::format("{}", *number + 1)};
    return {"3", "5", "7", "9"};
  case Kind::choice: return option.words;
  case Kind::flag: return {"yes"};
  case Kind::list: return {option.initial};
  case Kind::numbers: return {"0.7"};
  case Kind::input: return {files.levels, files.states, files.rates};
  case Kind::text: return {"v", "rest", "-2*v"};  // an observable, a start, a drag
  case Kind::path: return {"other"};
  }
  return {};
}

bool without_effect(const Request& request, const std::string& option) {
  const auto& warnings = request.warnings;
  return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
    return warning.starts_with("-" + option + " = ");
  });
}

std::string complaint(const Request& request, const std::string& file) {
  try {
    (void)run::simulate(PETSC_COMM_SELF, request, file, {});
  } catch (const BadInput& bad) {
    return bad.what();
  }
  return "nothing";
}

/// What a checkpoint of `line` says to the same with another value of the option; nothing if the
/// line takes no other value.
std::optional<std::string> complaint(const Options& line, const Option& option,
                                     const NoiseFiles& files, const std::string& file) {
  const std::string now = line.contains(option.name) ? line.at(option.name) : option.initial;
  for (const auto& value : others(option, now, files)) {
    if (value == now) continue;
    auto changed = line;
    changed[option.name] = value;
    const auto request = read(changed);
    if (!request || without_effect(*request, option.name)) continue;
    return complaint(*request, file);
  }
  return std::nullopt;
}

std::string written(const std::string& file, const char* text) {
  std::ofstream(file) << text;
  return file;
}

}  // namespace

// The table of options is the program's own, so that a new option has to be in the identity, or in
// the list of those that may change.
TEST_CASE("monte carlo: a checkpoint belongs to the value of every option of the table", "[long]") {
  const test::TemporaryFolder folder;
  const NoiseFiles given{
      written(folder / "levels.csv", "x,rate_up,rate_down\n-1.5,1,0\n0,1,1\n1.5,0,1\n"),
      written(folder / "states.csv", "x\n-1.5\n0\n1.5\n"),
      written(folder / "rates.csv", "from,to,rate\n0,1,1\n1,0,1\n1,2,1\n2,0,1\n")};
  const NoiseFiles changed{
      written(folder / "other_levels.csv", "x,rate_up,rate_down\n-1.5,1,0\n0,1,1\n1.6,0,1\n"),
      written(folder / "other_states.csv", "x\n-1.5\n0\n1.6\n"),
      written(folder / "other_rates.csv", "from,to,rate\n0,1,1\n1,0,1\n1,2,1\n2,0,2\n")};
  const auto lines = command_lines(given);
  std::vector<std::string> files;
  for (const auto& line : lines) {
    const auto request = read(line);
    REQUIRE(request);
    for (const auto& other : files) {
      CHECK_THAT(complaint(*request, other), Catch::Contains("belongs to a simulation with"));
    }
    files.push_back(folder / fmt::format("{}.checkpoint", files.size()).c_str());
    CHECK(complaint(*request, files.back()) == "nothing");
  }
  const std::set<std::string> of_other_runs{"Study", "Sweep", "Output"};
  for (const auto& group : table()) {
    if (of_other_runs.contains(group.title)) continue;
    for (const auto& option : group.options) {
      if (kFree.contains(option.name)) continue;
      INFO("-" << option.name);
      int tried = 0;
      for (std::size_t n = 0; n < lines.size(); ++n) {
        const auto found = complaint(lines[n], option, changed, files[n]);
        if (!found) continue;
        ++tried;
        INFO("command line " << n);
        CHECK_THAT(*found, Catch::Contains("belongs to a simulation with"));
      }
      CHECK((tried > 0) != kWithOthers.contains(option.name));
    }
  }
}
