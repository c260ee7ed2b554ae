#include "stickslip/petsc/split_matrix.hpp"

#include <memory>
#include <utility>
#include <vector>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/dense.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::petsc {
namespace {

// Called by PETSc.

const SplitMatrix& context(Mat matrix) {
  SplitMatrix* own = nullptr;
  check(MatShellGetContext(matrix, static_cast<void*>(&own)));
  return *own;
}

template <bool transposed>
PetscErrorCode multiplied(Mat matrix, Vec x, Vec y) {
  return guarded([&] { context(matrix).multiply(x, y, transposed); });
}

PetscErrorCode destroy(Mat matrix) {
  return guarded([&] { delete &context(matrix); });
}

template <class Function>
void set_operation(Mat matrix, MatOperation operation, Function function) {
  check(MatShellSetOperation(matrix, operation, reinterpret_cast<void (*)()>(function)));
}

void take_magnitudes_of_block(Mat block) {
  MatInfo info{};
  check(MatGetInfo(block, MAT_LOCAL, &info));
  PetscScalar* values = nullptr;
  check(MatSeqAIJGetArray(block, &values));
  take_sizes({values, static_cast<std::size_t>(info.nz_used)});
  check(MatSeqAIJRestoreArray(block, &values));
}

}  // namespace

MatHandle SplitMatrix::make(MatHandle sparse, Jumps jumps, Transport transport) {
  PetscInt local = 0, global = 0;
  check(MatGetLocalSize(sparse, &local, nullptr));
  check(MatGetSize(sparse, &global, nullptr));
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(static_cast<Mat>(sparse)));
  std::unique_ptr<SplitMatrix> own(
      new SplitMatrix(std::move(sparse), std::move(jumps), std::move(transport)));
  MatHandle matrix;
  check(MatCreateShell(comm, local, local, global, global, own.get(), matrix.out()));
  (void)own.release();  // to the matrix
  set_operation(matrix, MATOP_DESTROY, destroy);
  set_operation(matrix, MATOP_MULT, multiplied<false>);
  set_operation(matrix, MATOP_MULT_TRANSPOSE, multiplied<true>);
  return matrix;
}

const SplitMatrix* SplitMatrix::of(Mat matrix) {
  PetscBool shell = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix), MATSHELL, &shell));
  return shell == PETSC_TRUE ? &context(matrix) : nullptr;
}

void SplitMatrix::multiply(Vec x, Vec y, bool transposed) const {
  check(transposed ? MatMultTranspose(sparse_, x, y) : MatMult(sparse_, x, y));
  const ReadView from(x);
  WriteView to(y);
  jumps_.add(from.data(), to.data(), transposed);
  transport_.subtract(from.data(), to.data(), transposed);
}

MatHandle magnitudes(Mat matrix) {
  if (const SplitMatrix* split = SplitMatrix::of(matrix)) {
    return SplitMatrix::make(magnitudes(split->sparse()), split->jumps().sizes(),
                             split->transport().sizes());
  }
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

VecHandle magnitude_sums(Mat matrix) {
  if (const SplitMatrix* split = SplitMatrix::of(matrix)) {
    VecHandle sums = magnitude_sums(split->sparse());
    WriteView local(sums);
    const std::vector<PetscScalar> ones(static_cast<std::size_t>(local.size()), 1.0);
    split->jumps().sizes().add(ones.data(), local.data(), false);
    split->transport().sizes().subtract(ones.data(), local.data(), false);
    return sums;
  }
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

}  // namespace stickslip::petsc
