#pragma once
/// What computes a result: model parameters, question and method.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stickslip/case/entry.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::cases {

/// Discretisation in v; `none` for the fluid queue, which needs none.
enum class Scheme { hp, upwind, none };

/// What factors the sliding operator, and where they go; the PETSc options of -slide_ decide.
/// `own`: what fits the discretisation, element by element or by MUMPS in memory.
enum class Factors { own, elements, in_memory, on_disk, incomplete };

/// How the spectrum is computed.
enum class SpectrumSolver { krylov, direct };

/// A value of other origin, with a 95 % confidence interval.
struct Reference {
  std::string quantity;            ///< key of a result, such as P_stick or S_v
  std::optional<double> argument;  ///< lambda, omega, time or k, for an array
  double value = 0, low = 0, high = 0;
};

/// What is asked for, and how accurate it has to be.
struct Question {
  std::set<Quantity> quantities = {};
  /// Arguments that quantities share (case/entry.cpp), by their options.
  std::vector<double> lambda = {}, omega = {}, time = {}, distance = {}, inverse_distance = {},
                      velocity = {};
  std::map<std::string, std::vector<double>, std::less<>> arguments = {};  ///< others, by option
  std::vector<model::Observable> observables = {};  ///< of averages, resolvent and expectation
  model::Start start = {};  ///< of expectation, displacement, first_passage and trajectory
  model::Passage passage = model::Passage::both;  ///< of first_passage
  double horizon = 100;                           ///< end of the trajectory [time]
  double accuracy = 1e-6;
  bool accuracy_given = false;             ///< by the user
  std::vector<Reference> references = {};  ///< of -compare

  [[nodiscard]] bool wants(Quantity q) const { return quantities.contains(q); }
  /// The values given for an argument, shared or not.
  [[nodiscard]] std::vector<double> values(std::string_view option) const {
    if (const auto shared = shared_argument(option)) return this->*shared;
    const auto given = arguments.find(option);
    return given == arguments.end() ? std::vector<double>() : given->second;
  }
  /// Gives an argument its values.
  void set_values(const std::string& option, std::vector<double> values) {
    const auto shared = shared_argument(option);
    (shared != nullptr ? this->*shared : arguments[option]) = std::move(values);
  }
  /// Whether a fact holds of anything asked for.
  [[nodiscard]] bool any(bool Entry::*fact) const {
    return std::ranges::any_of(
        entries(), [&](const Entry* entry) { return wants(entry->quantity) && entry->*fact; });
  }
  /// The loosest that is usual for what is asked for; 0 where all take that of the option.
  [[nodiscard]] double usual_accuracy() const {
    double loosest = 0;
    for (const auto* entry : entries()) {
      if (wants(entry->quantity)) loosest = std::max(loosest, entry->usual_accuracy);
    }
    return loosest;
  }
  /// Whether anything asked for depends on the option (a name without dash).
  [[nodiscard]] bool depends_on(std::string_view option) const {
    return std::ranges::any_of(entries(), [&](const Entry* entry) {
      return wants(entry->quantity) && entry->takes(option);
    });
  }

 private:
  using Values = std::vector<double> Question::*;
  [[nodiscard]] static Values shared_argument(std::string_view option) {
    for (const auto& [name, values] : std::initializer_list<std::pair<std::string_view, Values>>{
             {"lambda", &Question::lambda},
             {"omega", &Question::omega},
             {"time", &Question::time},
             {"distance", &Question::distance},
             {"inverse_distance", &Question::inverse_distance},
             {"velocity", &Question::velocity}}) {
      if (name == option) return values;
    }
    return nullptr;
  }
};

/// How it is computed; a degree, layers or points switch refinement off.
struct Method {
  Route route = Route::excursion;
  Scheme scheme = Scheme::hp;
  std::optional<int> degree = {}, layers = {};  ///< hp
  std::optional<int> points = {};               ///< upwind, per noise step
  std::optional<int> noise_degree = {};         ///< hp; 0: every noise level is a node
  double noise_grading = 2;                     ///< hp
  Factors factors = Factors::own;
  SpectrumSolver spectrum_solver = SpectrumSolver::krylov;
  double excursions = 1e6;  ///< of -route monte_carlo, at most
  std::uint64_t seed = 1;   ///< of whatever is simulated

  /// What is known of the solution method.
  [[nodiscard]] const SolutionMethod& row() const { return method_of(route); }
  /// Whether the discretisation is chosen by hand.
  [[nodiscard]] bool fixed() const {
    return degree || layers || points || noise_degree.value_or(0) > 0;
  }
};

/// All that fixes the numbers of a result, but for the PETSc options of the solvers.
struct Case {
  model::Scene scene;
  Question question;
  Method method;
};

}  // namespace stickslip::cases
