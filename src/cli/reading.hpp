#pragma once
/// Steps of reading a request, some of which sweeps share.

#include <optional>
#include <string>
#include <vector>

#include "stickslip/cli/options.hpp"
#include "stickslip/cli/request.hpp"

namespace stickslip::cli {

// Words of choices beside what they mean.

template <class Value>
struct Word {
  const char* word;
  Value value;
  const char* synonyms = "";  // words that mean it elsewhere, a comma list
};

inline constexpr Word<Scheme> kSchemes[] = {{"hp", Scheme::hp, "dg, fem, galerkin"},
                                            {"upwind", Scheme::upwind, "finite_difference, fd"}};
inline constexpr Word<SpectrumSolver> kSpectrumSolvers[] = {{"krylov", SpectrumSolver::krylov},
                                                            {"direct", SpectrumSolver::direct}};
inline constexpr Word<model::Passage> kPassages[] = {
    {"both", model::Passage::both}, {"up", model::Passage::up}, {"down", model::Passage::down}};
inline constexpr Word<StudyKind> kStudies[] = {
    {"none", StudyKind::none},           {"p", StudyKind::points},
    {"delta", StudyKind::steps},         {"tau", StudyKind::white_noise},
    {"heuristic", StudyKind::heuristic}, {"cost", StudyKind::cost}};
/// Whether progress is shown; where that is open, the terminal decides.
inline constexpr Word<std::optional<bool>> kProgress[] = {
    {"auto", std::nullopt}, {"on", true}, {"off", false}};

/// The words in their order; `all` is a range of values with a member `word`.
template <class Words>
[[nodiscard]] std::vector<std::string> words_of(const Words& all) {
  std::vector<std::string> words;
  for (const auto& each : all) words.emplace_back(each.word);
  return words;
}

/// What a word means that was found to be one of `all`.
template <class Value, std::size_t N>
[[nodiscard]] Value meaning(const Word<Value> (&all)[N], const std::string& word) {
  for (const auto& each : all) {
    if (each.word == word) return each.value;
  }
  return all[0].value;
}

// request.cpp

/// The words of -quantities. With a given force, trajectory is its motion.
[[nodiscard]] std::vector<std::string> asked_quantities(const Settings& settings);

// rules.cpp

/// Options that exclude one another, lack one another, or have no effect, which is a warning.
void check_rules(Settings& settings, Request& request);

// request.cpp

/// Names of the files, and whether progress is shown.
[[nodiscard]] Files read_files(const Settings& settings);

/// The run that the settings ask for; what is wrong with it is added to their problems.
[[nodiscard]] Request request_of(Settings& settings);

// sweep.cpp

/// Whether an option -sweep_<option> is given.
[[nodiscard]] bool sweeps(const Settings& settings);

/// The request of the first point, with the sweep in it, after all points have been validated.
/// Throws BadInput.
[[nodiscard]] Request read_sweep(Settings settings);

}  // namespace stickslip::cli
