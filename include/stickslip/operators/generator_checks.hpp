#pragma once
/// What holds of every generator and every occupation, whatever the model parameters: where it
/// fails, the program is at fault, and no number is given.

#include <petscvec.h>

#include <span>

#include "stickslip/model/process.hpp"

namespace stickslip::operators {

/// Rows of A = lambda - L that one rank has, by columns in rising order with the diagonal.
struct LocalRows {
  PetscInt first;  ///< global number of the first row
  std::span<const PetscInt> row_start, columns;
  std::span<const PetscScalar> values;
};

/// What a discretisation promises of its rows.
struct Promise {
  bool monotone;  ///< off-diagonals of -A >= 0 and row sums >= 0: an upwind velocity discretisation
  bool conservative;  ///< row sums are zero: nothing is killed and lambda = 0
};

/// Throws NotReached, with the row and the model parameters to report, if a promise is broken on
/// any rank. Collective. O(nonzeros).
void require_generator(MPI_Comm comm, const LocalRows& rows, Promise promise,
                       const model::Process& process);

/// Throws NotReached, with the model parameters to report, if an occupation has entries below zero
/// by more than rounding, 1e-9 of the largest one: on a monotone velocity discretisation there are
/// none. Collective. O(size).
void require_occupation(Vec nu, const model::Process& process);

}  // namespace stickslip::operators
