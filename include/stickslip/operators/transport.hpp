#pragma once
/// Transport along the velocity axis, to be applied element by element.

#include "stickslip/model/process.hpp"
#include "stickslip/operators/state_space.hpp"
#include "stickslip/petsc/transport.hpp"
#include "stickslip/velocity/hp_axis.hpp"

namespace stickslip::operators {

/// That of the local levels of all halves, half by half, element by element from v = 0. Local.
/// O(elements + levels).
[[nodiscard]] petsc::Transport transport(const StateSpace& states, const model::Process& process,
                                         const velocity::HpAxis& axis);

}  // namespace stickslip::operators
