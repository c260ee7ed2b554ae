#include "stickslip/petsc/dense.hpp"

#include <petscsys.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

namespace stickslip::petsc {

void product(const char* how, int m, int n, int k, double factor, const PetscScalar* a,
             int stride_a, const PetscScalar* b, int stride_b, double keep, PetscScalar* c,
             int stride_c) {
  const PetscBLASInt rows = m, columns = n, inner = k, lda = stride_a, ldb = stride_b,
                     ldc = stride_c;
  const PetscScalar alpha = factor, beta = keep;
  BLASgemm_(how, how + 1, &rows, &columns, &inner, &alpha, a, &lda, b, &ldb, &beta, c, &ldc);
}

bool invert(PetscScalar* a, int n, int stride, std::span<PetscBLASInt> pivots,
            std::span<PetscScalar> work) {
  const PetscBLASInt size = n, lda = stride, length = static_cast<PetscBLASInt>(work.size());
  PetscBLASInt info = 0;
  LAPACKgetrf_(&size, &size, a, &lda, pivots.data(), &info);
  if (info == 0) LAPACKgetri_(&size, a, &lda, pivots.data(), work.data(), &length, &info);
  return info == 0;
}

}  // namespace stickslip::petsc
