#pragma once
/// Operations on lists of scalars, and on dense blocks by columns, which may be parts of larger
/// ones.

#include <petscsys.h>

#include <span>

namespace stickslip::petsc {

/// Each value becomes its absolute value.
void take_sizes(std::span<PetscScalar> values);

/// C <- factor A B + keep C with C m x n and the inner size k. `how` is "NN", or has T for a matrix
/// that is taken transposed; each matrix is followed by its stride.
void product(const char* how, int m, int n, int k, double factor, const PetscScalar* a,
             int stride_a, const PetscScalar* b, int stride_b, double keep, PetscScalar* c,
             int stride_c);

/// Inverts a small n x n block in place with exchanges of rows; false if it is singular.
/// `exchanges`: work space of n entries. 2 n^3 operations. LAPACK takes 12 times as long at n = 2,
/// 3 times at 8, 1.5 at 16.
[[nodiscard]] bool invert(PetscScalar* a, int n, int stride, std::span<int> exchanges);

}  // namespace stickslip::petsc
