#pragma once
/// Noises that are tables of levels.

#include <vector>

#include "stickslip/model/effect.hpp"

namespace stickslip::effects {

/// Sets the levels of the noise of a scene by its effect, unless numbers may be without meaning.
/// What is wrong with the levels is reported as a problem of `option`. Whether there are levels;
/// each counts, so that their range is not open.
[[nodiscard]] bool make_levels(Given& given, model::Scene& scene, const char* option,
                               const char* fix);

/// States of forces x and the jumps between them.
struct States {
  std::vector<double> x;
  std::vector<model::Transition> transitions;

  [[nodiscard]] model::LevelTable table() const { return {x, transitions}; }
};

/// All pairs of a state of a and one of b, which jump by themselves: the forces add. State (n, m)
/// has the number n * (states of b) + m. Throws std::invalid_argument where that is too many.
[[nodiscard]] States sum(const States& a, const States& b);

// Gaussian noises, without levels.

/// Makes the noise of a scene that of a covariance; what is wrong with it is a problem of `option`.
void make_continuous(Given& given, model::Scene& scene,
                     const std::vector<model::CovarianceTerm>& terms, const char* option,
                     const std::string& fix);
/// Whether a number that files state of a Gaussian noise is fixed by others, or is none.
[[nodiscard]] bool is_given_by_another(const model::Scene& scene, std::string_view option);
/// Its nodes. Whether there are any.
[[nodiscard]] bool complete_continuous(Given& given, model::Scene& scene);

/// Ties the body of a scene that is otherwise complete to a spring.
void read_spring(Given& given, model::Scene& scene);

/// Throws std::invalid_argument unless so many states can be meant.
void require_number_of_states(double count);

// Options of Gaussian noise. Formulas may hold the correlation time whatever the noise.

inline constexpr const char *kTau = "tau", *kDelta = "delta", *kLevels = "noise_levels",
                            *kDeviation = "noise_deviation", *kStiffness = "spring_stiffness";
[[nodiscard]] Option tau_option();
[[nodiscard]] Option deviation_option();

}  // namespace stickslip::effects
