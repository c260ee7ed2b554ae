#pragma once
/// Drag laws that are given by a formula.

#include "stickslip/model/effect.hpp"

namespace stickslip::effects {

/// Makes the drag of the scene from a formula in v, mu_s, mu_d and tau, after examining it at the
/// speeds that the noise brings about. Returns whether it can be a drag; where not, that is
/// reported of `option`.
bool set_drag(Given& given, model::Scene& scene, const char* option, const std::string& formula);

}  // namespace stickslip::effects
