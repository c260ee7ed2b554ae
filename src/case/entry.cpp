#include "stickslip/case/entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "stickslip/base/text.hpp"
#include "stickslip/case/displacement_rows.hpp"
#include "stickslip/case/duration_rows.hpp"
#include "stickslip/case/force_rows.hpp"
#include "stickslip/case/passage_rows.hpp"
#include "stickslip/case/spectrum_rows.hpp"
#include "stickslip/case/sticking_rows.hpp"

namespace stickslip::cases {

// The quantity density: stationary distribution as a field in the file of -output.

inline constexpr Entry kDensity{
    .quantity = Quantity::density,
    .word = "density",
    .synonyms = "pdf, stationary, distribution, invariant_measure, histogram",
    .title = "stationary distribution as a field in the file of -output",
    .routes = {Route::excursion},
    .of_one_run = true};

// Lists of numbers that more than one quantity or method takes. A quantity names them among its
// options.

inline constexpr Argument kLambda{
    .option = "lambda",
    .unit = "1/time",
    .sentence = "arguments of the Laplace transforms and resolvents",
    .besides = "With -route lambda one positive value, chosen from -accuracy unless given",
    .example = "0.1,1,10",
    .low = 0,
    .low_included = true};

inline constexpr Argument kOmega{.option = "omega",
                                 .unit = "1/time",
                                 .sentence = "angular frequencies",
                                 .example = "0.01:10:31:log",
                                 .synonyms = "freq, frequency, frequencies",
                                 .low = 0,
                                 .low_included = true,
                                 .optional = true};

inline constexpr Argument kTime{.option = "time",
                                .unit = "time",
                                .sentence = "times",
                                .example = "0.01:10:31:log",
                                .synonyms = "t, times",
                                .low = 0,
                                .low_included = true};

inline constexpr Argument kDistance{.option = "distance",
                                    .unit = "velocity*time",
                                    .sentence =
                                        "distances, positive where they are lengths of paths,",
                                    .example = "0.01:10:31:log",
                                    .optional = true};

inline constexpr Argument kInverseDistance{.option = "inverse_distance",
                                           .unit = "1/(velocity*time)",
                                           .sentence = "arguments s of the transform F_slip",
                                           .example = "0.1,1,10",
                                           .low = 0,
                                           .low_included = true,
                                           .optional = true};

inline constexpr Argument kVelocity{.option = "velocity",
                                    .unit = "velocity",
                                    .sentence = "speeds w > 0",
                                    .example = "0.1:2:20",
                                    .synonyms = "speed, speeds",
                                    .low = 0};

namespace {

constexpr const Entry* kAll[] = {&kSticking,
                                 &kMoments,
                                 &kAverages,
                                 &kNoiseLaw,
                                 &kNoiseSpectrum,
                                 &kEntryLaw,
                                 &kDensity,
                                 &kLaplace,
                                 &kStickTransform,
                                 &kResolvent,
                                 &kRelaxation,
                                 &kSpectrum,
                                 &kPhaseDurations,
                                 &kDurationDensity,
                                 &kAutocorrelation,
                                 &kSlip,
                                 &kPeak,
                                 &kFirstPassageTime,
                                 &kPassageTimeTransform,
                                 &kPassageTimeDistribution,
                                 &kDisplacement,
                                 &kExpectation,
                                 &kTrajectory,
                                 &kGivenForce,
                                 &kSensitivity,
                                 &kLargeDeviation,
                                 &kDisplacementTransform,
                                 &kDisplacementDistribution};

// Whether `key` is the derivative of a scalar by a parameter, such as dP_stick_dtau.
bool is_derivative(std::string_view key) {
  const auto derivable = [](std::string_view of) {
    const Entry* entry = entry_of(of);
    return entry == &kSticking || entry == &kMoments || entry == &kNoiseLaw;
  };
  if (!key.starts_with('d')) return false;
  for (const std::string_view parameter : kDifferentiatedBy) {
    const std::string by = fmt::format("_d{}", parameter);
    const std::size_t ends = 1 + by.size();
    const bool has_both = key.size() > ends && key.ends_with(by);
    if (has_both && derivable(key.substr(1, key.size() - ends))) return true;
  }
  return false;
}

// pi(f|stick) for pi(v^2|stick), dA_dp for dP_stick_dtau, and any other key as it is.
std::string pattern_of(std::string_view key) {
  const auto open = key.find('(');
  if (open == key.npos || !key.ends_with(')')) {
    return is_derivative(key) ? std::string(kDerivative.key) : std::string(key);
  }
  for (const std::string_view phase : {"|stick)", "|slide)"}) {
    if (key.ends_with(phase)) return fmt::format("{}(f{}", key.substr(0, open), phase);
  }
  return fmt::format("{}(f)", key.substr(0, open));
}

std::pair<const Entry*, const Row*> find(std::string_view key) {
  const std::string pattern = pattern_of(key);
  for (const Entry* entry : kAll) {
    for (const Row* row : entry->rows) {
      const bool of_number =
          (row->key.ends_with("(t)") || row->key.ends_with("(w)")) && pattern.ends_with("(f)") &&
          row->key.substr(0, row->key.size() - 2) == pattern.substr(0, pattern.size() - 2);
      if (row->key == pattern || of_number) return {entry, row};
    }
  }
  return {nullptr, nullptr};
}

}  // namespace

std::string Row::key_of(std::string_view f) const {
  const auto open = key.find('(') + 1;
  return fmt::format("{}{}{}", key.substr(0, open), f, key.substr(open + 1));
}

std::vector<std::string> Entry::all_options() const {
  auto all = split(options, ',');
  for (const Argument* argument : arguments) all.emplace_back(argument->option);
  return all;
}

bool Entry::takes(std::string_view option) const {
  const auto all = all_options();
  return std::find(all.begin(), all.end(), option) != all.end();
}

std::span<const Entry* const> entries() { return kAll; }

std::span<const Argument* const> arguments() {
  static const auto all = [] {
    std::vector<const Argument*> found{&kLambda,   &kOmega,           &kTime,
                                       &kDistance, &kInverseDistance, &kVelocity};
    for (const Entry* entry : kAll) {
      for (const Argument* argument : entry->arguments) {
        if (std::find(found.begin(), found.end(), argument) == found.end())
          found.push_back(argument);
      }
    }
    return found;
  }();
  return all;
}

std::string takers_of(std::string_view option) {
  std::vector<std::string> words;
  for (const Entry* entry : kAll) {
    if (entry->takes(option)) words.emplace_back(entry->word);
  }
  return enumerate(words, "and");
}

const Entry* find_entry(std::string_view word) {
  const auto* const found = std::find_if(std::begin(kAll), std::end(kAll),
                                         [&](const Entry* entry) { return entry->word == word; });
  return found == std::end(kAll) ? nullptr : *found;
}

const Entry* entry_of(std::string_view key) { return find(key).first; }

const Row* find_row(std::string_view key) { return find(key).second; }

namespace {

// In the order of Route.
constexpr SolutionMethod kMethods[] = {
    {.route = Route::excursion,
     .word = "excursion",
     .sentence = "one transposed solve gives the stationary distribution. The others check it",
     .needs_sticking = false,
     .bounds_speed = true,
     .closed_noise_law = true},
    {.route = Route::lambda,
     .word = "lambda",
     .sentence = "lambda u_lambda for small lambda",
     .limit = "lambda u_lambda tends to stationary averages as lambda -> 0, and gives nothing else",
     .full_grid = true,
     .small_lambda = true},
    {.route = Route::hitting,
     .word = "hitting",
     .sentence = "mean hitting times",
     .limit = "mean hitting times give mean durations, and nothing else",
     .full_grid = true},
    {.route = Route::null_vector,
     .word = "null_vector",
     .sentence = "left null vector of the generator",
     .limit = "the left null vector of the generator is the stationary distribution, and gives its "
              "averages alone",
     .full_grid = true,
     .needs_sticking = false},
    {.route = Route::fluid_queue,
     .word = "fluid_queue",
     .sentence = "b = 0",
     .limit = "the fluid queue gives the hitting distribution, durations and the moments of V up "
              "to the second",
     .without_drag = "only then is it a fluid queue",
     .discretises_velocity = false},
    {.route = Route::monte_carlo,
     .word = "monte_carlo",
     .synonyms = "mc, simulation, simulate",
     .sentence = "simulation",
     .limit = "a sample has no eigenvalues, no derivatives, and no density at a point (take "
              "averages of indicator functions such as abs(v)>0.5)",
     .discretises_velocity = false,
     .simulates = true}};

}  // namespace

std::span<const SolutionMethod> solution_methods() { return kMethods; }

const SolutionMethod& method_of(Route route) { return kMethods[static_cast<std::size_t>(route)]; }

const SolutionMethod& method_of(std::string_view word) {
  for (const auto& method : kMethods) {
    if (method.word == word) return method;
  }
  return kMethods[0];
}

}  // namespace stickslip::cases
