#pragma once
/// The scalar type of this build variant, and dense matrices of it.

#include <petscsys.h>

#include <vector>

#include "stickslip/algebra/dense.hpp"

namespace stickslip::petsc {

inline constexpr bool kComplex = PetscDefined(USE_COMPLEX);

using DenseMatrix = algebra::Matrix<PetscScalar>;
using DenseFactors = algebra::LuFactors<PetscScalar>;
using Scalars = std::vector<PetscScalar>;
using algebra::add_product;

}  // namespace stickslip::petsc
