#include "stickslip/petsc/backward_error.hpp"

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::petsc {
namespace {

// Of the largest component of a forward solution: smaller ones need not be right relative to their
// own size. Where an element is thin or a transform has decayed they are tens of orders smaller,
// and the factors mix their rows with others; what that does to a functional shows in the last step
// of iterative refinement.
constexpr double kNegligible = 1e-13;

void take_magnitudes_of_block(Mat block) {
  MatInfo info{};
  check(MatGetInfo(block, MAT_LOCAL, &info));
  PetscScalar* values = nullptr;
  check(MatSeqAIJGetArray(block, &values));
  for (PetscInt n = 0; n < static_cast<PetscInt>(info.nz_used); ++n) {
    values[n] = PetscAbsScalar(values[n]);
  }
  check(MatSeqAIJRestoreArray(block, &values));
}

MatHandle magnitudes(Mat matrix) {
  MatHandle copy;
  check(MatDuplicate(matrix, MAT_COPY_VALUES, copy.out()));
  PetscBool sequential = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATSEQAIJ, &sequential));
  if (sequential == PETSC_TRUE) {
    take_magnitudes_of_block(copy);
  } else {
    Mat diagonal = nullptr, off_diagonal = nullptr;
    check(MatMPIAIJGetSeqAIJ(copy, &diagonal, &off_diagonal, nullptr));
    take_magnitudes_of_block(diagonal);
    take_magnitudes_of_block(off_diagonal);
  }
  return copy;
}

// Of the rows.
VecHandle magnitude_sums(Mat matrix) {
  VecHandle sums;
  check(MatCreateVecs(matrix, nullptr, sums.out()));
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &begin, &end));
  WriteView local(sums);
  for (PetscInt r = begin; r < end; ++r) {
    double sum = 0;
    RowView(matrix, r).for_each(
        [&sum](PetscInt, PetscScalar value) { sum += PetscAbsScalar(value); });
    local[r - begin] = sum;
  }
  return sums;
}

VecHandle absolute(Vec x) {
  VecHandle size;
  check(VecDuplicate(x, size.out()));
  check(VecCopy(x, size));
  check(VecAbs(size));
  return size;
}

}  // namespace

double BackwardError::forward(Vec residual, Vec b, Vec x) {
  if (magnitude_ == nullptr) magnitude_ = magnitudes(matrix_);
  const VecHandle size = absolute(x), bound = absolute(b);
  PetscReal largest = 0, error = 0;
  check(VecNorm(x, NORM_INFINITY, &largest));
  check(VecShift(size, kNegligible * largest));
  check(MatMultAdd(magnitude_, size, bound, bound));
  check(VecPointwiseDivide(residual, residual, bound));  // 0/0 counts as 0 in PETSc
  check(VecNorm(residual, NORM_INFINITY, &error));
  return error;
}

// The sum of |A|^T |x| takes the sums of the rows of |A| alone.
double BackwardError::transposed(Vec residual, Vec b, Vec x) {
  if (magnitude_sums_ == nullptr) magnitude_sums_ = magnitude_sums(matrix_);
  const VecHandle size = absolute(x);
  PetscScalar visits = 0;
  PetscReal error = 0, b_size = 0;
  check(VecTDot(magnitude_sums_, size, &visits));
  check(VecNorm(b, NORM_1, &b_size));
  check(VecNorm(residual, NORM_1, &error));
  return error == 0 ? 0 : error / (PetscRealPart(visits) + b_size);
}

}  // namespace stickslip::petsc
