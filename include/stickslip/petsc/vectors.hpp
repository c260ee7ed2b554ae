#pragma once
/// Local views of distributed vectors and matrices, and the inner product of vectors.

#include <span>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/handle.hpp"

namespace stickslip::petsc {

/// Read access to the local part of a Vec for the life of the view. Not collective.
class ReadView {
 public:
  explicit ReadView(Vec vec) : vec_(vec) {
    check(VecGetLocalSize(vec_, &size_));
    check(VecGetArrayRead(vec_, &data_));
  }
  ~ReadView() { (void)VecRestoreArrayRead(vec_, &data_); }
  ReadView(const ReadView&) = delete;
  ReadView& operator=(const ReadView&) = delete;

  [[nodiscard]] const PetscScalar& operator[](PetscInt i) const { return data_[i]; }
  [[nodiscard]] PetscInt size() const { return size_; }
  [[nodiscard]] const PetscScalar* data() const { return data_; }

 private:
  Vec vec_;
  PetscInt size_ = 0;
  const PetscScalar* data_ = nullptr;
};

/// Write access to the local part of a Vec for the life of the view. Not collective.
class WriteView {
 public:
  explicit WriteView(Vec vec) : vec_(vec) {
    check(VecGetLocalSize(vec_, &size_));
    check(VecGetArray(vec_, &data_));
  }
  ~WriteView() { (void)VecRestoreArray(vec_, &data_); }
  WriteView(const WriteView&) = delete;
  WriteView& operator=(const WriteView&) = delete;

  [[nodiscard]] PetscScalar& operator[](PetscInt i) { return data_[i]; }
  [[nodiscard]] PetscInt size() const { return size_; }
  [[nodiscard]] PetscScalar* data() { return data_; }

 private:
  Vec vec_;
  PetscInt size_ = 0;
  PetscScalar* data_ = nullptr;
};

/// Read access to a local row of a Mat for the life of the view. Not collective.
class RowView {
 public:
  RowView(Mat matrix, PetscInt row) : matrix_(matrix), row_(row) {
    check(MatGetRow(matrix_, row_, &count_, &columns_, &values_));
  }
  ~RowView() { (void)MatRestoreRow(matrix_, row_, &count_, &columns_, &values_); }
  RowView(const RowView&) = delete;
  RowView& operator=(const RowView&) = delete;

  /// Calls visit(column, value) for each entry.
  template <class Visit>
  void for_each(Visit visit) const {
    for (PetscInt n = 0; n < count_; ++n) visit(columns_[n], values_[n]);
  }

 private:
  Mat matrix_;
  PetscInt row_, count_ = 0;
  const PetscInt* columns_ = nullptr;
  const PetscScalar* values_ = nullptr;
};

/// Collective.
[[nodiscard]] inline VecHandle copy_of(Vec vec) {
  VecHandle copy;
  check(VecDuplicate(vec, copy.out()));
  check(VecCopy(vec, copy));
  return copy;
}

/// Real part of sum_n a_n b_n, without conjugation. Collective.
[[nodiscard]] inline double dot(Vec a, Vec b) {
  PetscScalar sum = 0;
  check(VecTDot(a, b, &sum));
  return PetscRealPart(sum);
}

}  // namespace stickslip::petsc
