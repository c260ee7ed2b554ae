#pragma once
/// Small distributed matrices, row by row.

#include <petscmat.h>

#include <functional>
#include <utility>
#include <vector>

#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"

namespace stickslip::test {

using Row = std::vector<std::pair<PetscInt, double>>;  // columns and values

/// n x n on all ranks, row(r) lists the entries of row r. Collective.
inline linalg::MatHandle matrix(PetscInt n, const std::function<Row(PetscInt)>& row) {
  using linalg::check;
  linalg::MatHandle a;
  check(MatCreate(PETSC_COMM_WORLD, a.out()));
  check(MatSetSizes(a, PETSC_DECIDE, PETSC_DECIDE, n, n));
  check(MatSetType(a, MATAIJ));
  check(MatSetUp(a));
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(a, &begin, &end));
  for (PetscInt r = begin; r < end; ++r) {
    for (const auto& [c, value] : row(r)) check(MatSetValue(a, r, c, value, INSERT_VALUES));
  }
  check(MatAssemblyBegin(a, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(a, MAT_FINAL_ASSEMBLY));
  return a;
}

}  // namespace stickslip::test
