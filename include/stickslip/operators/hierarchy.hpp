#pragma once
/// A fine discretisation as one of lower degree and high modes.

#include "stickslip/operators/state_space.hpp"
#include "stickslip/petsc/high_modes.hpp"
#include "stickslip/velocity/axis.hpp"

namespace stickslip::operators {

/// How the states of `fine`, on `axis`, contain those of `coarse`, on the same elements with lower
/// degrees, both on hp axes. High modes are Legendre polynomials. Local. O(elements), besides other
/// states.
[[nodiscard]] petsc::Hierarchy hierarchy(const StateSpace& fine, const velocity::Axis& axis,
                                         const StateSpace& coarse,
                                         const velocity::Axis& coarse_axis);

}  // namespace stickslip::operators
