#include "stickslip/catalogue/entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "stickslip/catalogue/autocorrelation_keys.hpp"
#include "stickslip/catalogue/averages_keys.hpp"
#include "stickslip/catalogue/density_keys.hpp"
#include "stickslip/catalogue/displacement_distribution_keys.hpp"
#include "stickslip/catalogue/displacement_keys.hpp"
#include "stickslip/catalogue/displacement_transform_keys.hpp"
#include "stickslip/catalogue/duration_density_keys.hpp"
#include "stickslip/catalogue/entry_law_keys.hpp"
#include "stickslip/catalogue/expectation_keys.hpp"
#include "stickslip/catalogue/first_passage_keys.hpp"
#include "stickslip/catalogue/given_force_keys.hpp"
#include "stickslip/catalogue/laplace_keys.hpp"
#include "stickslip/catalogue/large_deviation_keys.hpp"
#include "stickslip/catalogue/moments_keys.hpp"
#include "stickslip/catalogue/noise_law_keys.hpp"
#include "stickslip/catalogue/noise_spectrum_keys.hpp"
#include "stickslip/catalogue/passage_distribution_keys.hpp"
#include "stickslip/catalogue/peak_keys.hpp"
#include "stickslip/catalogue/phase_durations_keys.hpp"
#include "stickslip/catalogue/relaxation_keys.hpp"
#include "stickslip/catalogue/resolvent_keys.hpp"
#include "stickslip/catalogue/sensitivity_keys.hpp"
#include "stickslip/catalogue/shared_arguments.hpp"
#include "stickslip/catalogue/slip_keys.hpp"
#include "stickslip/catalogue/spectrum_keys.hpp"
#include "stickslip/catalogue/stick_transform_keys.hpp"
#include "stickslip/catalogue/sticking_keys.hpp"
#include "stickslip/catalogue/trajectory_keys.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::catalogue {
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

}  // namespace stickslip::catalogue
