#pragma once
/// From the values of the model's options to a scene.

#include <string>

#include "stickslip/effects/effect.hpp"

namespace stickslip::effects {

/// What drives bodies, as far as anything is asked of it.
enum class Drive { noise, given_force, both };

/// The parameters of the model; v_max and the noise levels may stay open. What is wrong with them,
/// each by itself or together, is refused. What does not drive is not read.
[[nodiscard]] model::Scene read_scene(Given& given, Drive drive = Drive::noise);

/// How the chain of a scene's noise differs from the noise that is meant; may be empty.
[[nodiscard]] std::string noise_note(const model::Scene& scene);

/// What to say of a given force under which friction holds the body all the time; empty where it
/// moves, and without such a force.
[[nodiscard]] std::string force_note(const model::Scene& scene);

/// What to say where static friction acts with another value than the one given, because it lies
/// between two noise levels; empty where it does not.
[[nodiscard]] std::string step_warning(const model::Scene& scene);

}  // namespace stickslip::effects
