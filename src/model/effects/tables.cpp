#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "all.hpp"
#include "csv_rows.hpp"
#include "levels.hpp"
#include "stickslip/model/effect.hpp"

namespace stickslip::effects {
namespace {

constexpr const char *kStates = "noise_states", *kRates = "noise_rates", *kFile = "noise_file";

/// What is wrong with a file, as a problem of the option that names it.
class Unfit : public std::invalid_argument {
 public:
  Unfit(const char* option, const std::string& why) : std::invalid_argument(why), option_(option) {}
  [[nodiscard]] const char* option() const { return option_; }

 private:
  const char* option_;
};

template <std::size_t columns>
CsvRows<columns> read_rows(const char* option, const std::string& file,
                           const std::array<const char*, columns>& names) {
  try {
    return read_csv<columns>(file, names, ::io::ignore_extra_column);
  } catch (const std::exception& problem) {
    throw Unfit(option, problem.what());
  }
}

std::vector<model::Transition> transitions_of(const CsvRows<3>& rows, std::size_t states) {
  std::vector<model::Transition> all;
  std::map<std::pair<std::size_t, std::size_t>, unsigned> seen;
  for (std::size_t n = 0; n < rows.values.size(); ++n) {
    const auto [from, to, rate] = rows.values[n];
    const auto refuse = [&](const std::string& why) { throw Unfit(kRates, rows.place(n) + why); };
    for (double state : {from, to}) {
      if (state >= 0 && state < static_cast<double>(states) && state == std::floor(state)) continue;
      refuse(fmt::format("there is no state {:g}; those of -{} are numbered from 0 to {}", state,
                         kStates, states - 1));
    }
    if (from == to) refuse(fmt::format("state {:g} jumps to itself", from));
    if (rate < 0) refuse(fmt::format("rate = {:g} must not be negative", rate));
    const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
    const auto [before, first] = seen.try_emplace({a, b}, rows.lines[n]);
    if (!first) {
      refuse(fmt::format("line {} has the rate from state {} to state {} already", before->second,
                         a, b));
    }
    if (rate > 0) all.push_back({a, b, rate});
  }
  return all;
}

model::LevelTable read_chain(const std::string& states, const std::string& rates) {
  const auto given = read_rows<1>(kStates, states, {"x"});
  std::vector<double> x;
  for (const auto& row : given.values) x.push_back(row[0]);
  const auto transitions =
      transitions_of(read_rows<3>(kRates, rates, {"from", "to", "rate"}), x.size());
  try {
    return {x, transitions};
  } catch (const model::UnfitTable& unfit) {
    throw Unfit(kStates, given.place(unfit.row()) + unfit.what());
  }
}

bool complete_noise_chain(Given& given, model::Scene& scene) {
  if (!given.sound()) return false;
  try {
    make_noise_levels(scene);
    return true;
  } catch (const Unfit& unfit) {
    given.refuse(unfit.option(), unfit.what(),
                 unfit.option() == kStates
                     ? "write CSV with the column x, the force of one state a line, all of which "
                       "the rates connect"
                     : "write CSV with the columns from,to,rate, states by their lines from 0");
    return false;
  }
}

}  // namespace

const Effect kNoiseChain{
    .word = "chain",
    .sentence = "any Markov chain",
    .others = {"markov", "markov_chain", "ctmc"},
    .parameters = {{Option::file(kStates, Kind::input,
                                 "CSV with the column x: the force in each state of -noise chain, "
                                 "one a line, numbered from 0; several may have the same",
                                 {.label = "states of"}),
                    true, "states.csv"},
                   {Option::file(
                        kRates, Kind::input,
                        "CSV with the columns from,to,rate: the rates of the jumps between "
                        "the states of -noise_states, all others being 0",
                        {.label = "rates of", .others = {"generator", "noise_generator"}}),
                    true, "rates.csv"}},
    .complete = complete_noise_chain,
    .levels =
        [](const model::Scene& scene) {
          return read_chain(std::get<std::string>(own_value(scene, kStates)),
                            std::get<std::string>(own_value(scene, kRates)));
        },
    .heading =
        [](const model::Scene& scene) {
          return "noise chain of " + std::get<std::string>(own_value(scene, kStates));
        }};

model::LevelTable read_levels(const std::string& file) {
  CsvRows<3> rows;
  try {
    rows = read_csv<3>(file, {"x", "rate_up", "rate_down"}, ::io::ignore_no_column);
  } catch (const ::io::error::base& problem) {
    throw std::invalid_argument(
        fmt::format("is not a CSV file of levels: {}. A record of a force or an acceleration over "
                    "time (CSV, AT2, SAC) becomes one as docs/recorded_forces.md shows",
                    problem.what()));
  }
  std::vector<model::Level> levels;
  for (const auto& [x, up, down] : rows.values) levels.push_back({x, up, down});
  try {
    return model::LevelTable(levels);
  } catch (const model::UnfitTable& unfit) {
    throw std::invalid_argument(rows.place(unfit.row()) + unfit.what());
  }
}

const Effect kNoiseFile{
    .word = "file",
    .sentence = "any birth-death chain",
    .parameters = {{Option::file(
                        kFile, Kind::input,
                        "CSV with the columns x,rate_up,rate_down: the levels of -noise "
                        "file in rising order, and the rates of jumps to the next level "
                        "up and down, 0 at the ends",
                        {.label = "levels of",
                         .others = {"record", "recording", "force_record", "forcing", "data"},
                         .page = "docs/recorded_forces.md"}),
                    true, "levels.csv"}},
    .complete =
        [](Given& given, model::Scene& scene) {
          return make_levels(given, scene, kFile,
                             "write CSV with the columns x,rate_up,rate_down, x rising");
        },
    .levels =
        [](const model::Scene& scene) {
          return read_levels(std::get<std::string>(own_value(scene, kFile)));
        },
    .heading =
        [](const model::Scene& scene) {
          return "noise levels of " + std::get<std::string>(own_value(scene, kFile));
        }};

}  // namespace stickslip::effects
