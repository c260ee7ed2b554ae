#pragma once
/// Local views of distributed vectors, and their inner product.

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

 private:
  Vec vec_;
  PetscInt size_ = 0;
  const PetscScalar* data_ = nullptr;
};

/// Write access to the local part of a Vec for the life of the view. Not collective.
class WriteView {
 public:
  explicit WriteView(Vec vec) : vec_(vec) { check(VecGetArray(vec_, &data_)); }
  ~WriteView() { (void)VecRestoreArray(vec_, &data_); }
  WriteView(const WriteView&) = delete;
  WriteView& operator=(const WriteView&) = delete;

  [[nodiscard]] PetscScalar& operator[](PetscInt i) { return data_[i]; }

 private:
  Vec vec_;
  PetscScalar* data_ = nullptr;
};

/// Real part of sum_n a_n b_n, without conjugation. Collective.
[[nodiscard]] inline double dot(Vec a, Vec b) {
  PetscScalar sum = 0;
  check(VecTDot(a, b, &sum));
  return PetscRealPart(sum);
}

}  // namespace stickslip::petsc
