#include "stickslip/petsc/dense.hpp"

#include <petscsys.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

#include <algorithm>
#include <utility>

namespace stickslip::petsc {

void take_sizes(std::span<PetscScalar> values) {
  for (PetscScalar& value : values) value = PetscAbsScalar(value);
}

void product(const char* how, int m, int n, int k, double factor, const PetscScalar* a,
             int stride_a, const PetscScalar* b, int stride_b, double keep, PetscScalar* c,
             int stride_c) {
  const PetscBLASInt rows = m, columns = n, inner = k, lda = stride_a, ldb = stride_b,
                     ldc = stride_c;
  const PetscScalar alpha = factor, beta = keep;
  BLASgemm_(how, how + 1, &rows, &columns, &inner, &alpha, a, &lda, b, &ldb, &beta, c, &ldc);
}

// Gauss-Jordan: column k of the inverse takes the place of column k.
bool invert(PetscScalar* a, int n, int stride, std::span<int> exchanges) {
  const auto column = [&](int c) { return a + static_cast<std::ptrdiff_t>(stride) * c; };
  for (int k = 0; k < n; ++k) {
    PetscScalar* own = column(k);
    int largest = k;
    for (int r = k + 1; r < n; ++r) {
      if (PetscAbsScalar(own[r]) > PetscAbsScalar(own[largest])) largest = r;
    }
    if (own[largest] == 0.0) return false;
    exchanges[k] = largest;
    for (int c = 0; c < n && largest != k; ++c) std::swap(column(c)[k], column(c)[largest]);
    const PetscScalar inverse = 1.0 / own[k];
    for (int c = 0; c < n; ++c) {
      if (c == k) continue;
      PetscScalar* other = column(c);
      const PetscScalar factor = other[k] * inverse;
      for (int r = 0; r < n; ++r) other[r] -= factor * own[r];
      other[k] = factor;
    }
    for (int r = 0; r < n; ++r) own[r] *= -inverse;
    own[k] = inverse;
  }
  for (int k = n - 1; k >= 0; --k) {
    if (exchanges[k] != k) std::swap_ranges(column(k), column(k) + n, column(exchanges[k]));
  }
  return true;
}

}  // namespace stickslip::petsc
