#pragma once
/// Noises whose levels and rates are given one by one.

#include <functional>

#include "stickslip/effects/effect.hpp"

namespace stickslip::effects {

/// Sets the levels of the noise, unless numbers may be without meaning. What is wrong with the
/// levels is reported as a problem of `option`.
void set_levels(Given& given, model::Scene& scene, const char* option, const char* fix,
                const std::function<model::LevelTable()>& levels);

/// Whether the scene has levels; each counts, so that their range is not open.
[[nodiscard]] bool has_levels(Given& given, model::Scene& scene);

}  // namespace stickslip::effects
