#pragma once
/// What travels with the matrix of an operator, for preconditioners that use it.

#include <petscmat.h>

#include <memory>

#include "stickslip/operators/discretisation.hpp"
#include "stickslip/operators/state_space.hpp"

namespace stickslip::operators {

/// What a matrix is of: -L and what is added to it.
struct MatrixData {
  Discretisation discretisation;
  StateSpace states;
  Shift<PetscScalar> shift;
};

/// Composes the data on a matrix. Not collective.
void attach(Mat matrix, std::shared_ptr<const MatrixData> data);

/// The data of a matrix; null if it has none. Not collective.
[[nodiscard]] std::shared_ptr<const MatrixData> data_of(Mat matrix);

}  // namespace stickslip::operators
