#pragma once
/// A fine discretisation as one of lower degree and high modes.

#include "stickslip/operators/state_space.hpp"
#include "stickslip/petsc/high_modes.hpp"
#include "stickslip/velocity/hp_axis.hpp"

namespace stickslip::operators {

/// How the states of `fine`, on `axis`, contain those of `coarse`, on the same elements with lower
/// degrees. High modes are Legendre polynomials. Local. O(elements), besides other states.
[[nodiscard]] petsc::Hierarchy hierarchy(const StateSpace& fine, const velocity::HpAxis& axis,
                                         const StateSpace& coarse,
                                         const velocity::HpAxis& coarse_axis);

}  // namespace stickslip::operators
