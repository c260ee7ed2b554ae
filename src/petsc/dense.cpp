#include "stickslip/petsc/dense.hpp"

#include <petscsys.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

#include <utility>

#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {

void add_product(PetscScalar factor, const DenseMatrix& a, const DenseMatrix& b, int columns,
                 DenseMatrix& c) {
  const PetscBLASInt m = a.rows(), n = columns, k = a.columns(), ldb = b.rows(), ldc = c.rows();
  if (m == 0 || n == 0 || k == 0) return;
  const PetscScalar one = 1;
  BLASgemm_("N", "N", &m, &n, &k, &factor, a.data(), &m, b.data(), &ldb, &one, c.data(), &ldc);
}

DenseMatrix operator*(const DenseMatrix& a, const DenseMatrix& b) {
  DenseMatrix c(a.rows(), b.columns());
  add_product(1, a, b, b.columns(), c);
  return c;
}

void add_product(const DenseMatrix& a, const Scalars& x, Scalars& y, bool transposed) {
  const PetscBLASInt m = a.rows(), n = a.columns(), step = 1;
  if (m == 0 || n == 0) return;
  const PetscScalar one = 1;
  BLASgemv_(transposed ? "T" : "N", &m, &n, &one, a.data(), &m, x.data(), &step, &one, y.data(),
            &step);
}

DenseFactors::DenseFactors(DenseMatrix a)
    : lu_(std::move(a)), pivots_(static_cast<std::size_t>(lu_.rows())) {
  const PetscBLASInt n = lu_.rows();
  if (n == 0) return;
  PetscBLASInt info = 0;
  LAPACKgetrf_(&n, &n, lu_.data(), &n, pivots_.data(), &info);
  if (info != 0) throw NotReached("the factorisation met a singular block");
}

void DenseFactors::solve(DenseMatrix& b) const {
  const PetscBLASInt n = size(), columns = b.columns();
  if (n == 0 || columns == 0) return;
  PetscBLASInt info = 0;
  LAPACKgetrs_("N", &n, &columns, lu_.data(), &n, pivots_.data(), b.data(), &n, &info);
}

void DenseFactors::solve(PetscScalar* x, bool transposed) const {
  const PetscBLASInt n = size(), columns = 1;
  if (n == 0) return;
  PetscBLASInt info = 0;
  LAPACKgetrs_(transposed ? "T" : "N", &n, &columns, lu_.data(), &n, pivots_.data(), x, &n, &info);
}

}  // namespace stickslip::petsc
