#pragma once
/// Transport along the velocity axis and jumps of the noise, to be applied instead of stored.

#include "stickslip/model/process.hpp"
#include "stickslip/operators/state_space.hpp"
#include "stickslip/petsc/jumps.hpp"
#include "stickslip/petsc/transport.hpp"
#include "stickslip/velocity/hp_axis.hpp"

namespace stickslip::operators {

/// That of the local levels of all halves, half by half, element by element from v = 0. Local.
/// O(elements + levels).
[[nodiscard]] petsc::Transport transport(const StateSpace& states, const model::Process& process,
                                         const velocity::HpAxis& axis);

/// Jumps of lambda - L on the nodes of all halves. Local. O(levels).
[[nodiscard]] petsc::Jumps jumps(const StateSpace& states, const model::Process& process,
                                 const velocity::Axis& axis, PetscScalar lambda);

}  // namespace stickslip::operators
