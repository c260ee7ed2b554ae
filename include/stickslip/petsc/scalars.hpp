#pragma once
/// Dense matrices of PetscScalar.

#include <petscsys.h>

#include <vector>

#include "stickslip/algebra/dense.hpp"

namespace stickslip::petsc {

using DenseMatrix = algebra::Matrix<PetscScalar>;
using DenseFactors = algebra::LuFactors<PetscScalar>;
using Scalars = std::vector<PetscScalar>;
using algebra::add_product;

}  // namespace stickslip::petsc
