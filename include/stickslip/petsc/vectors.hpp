#pragma once
/// Local views of distributed vectors and matrices, and the inner product of vectors.

#include <span>
#include <vector>

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

/// Rows of a matrix, wherever they are. Collective.
class RowsOnAllRanks {
 public:
  RowsOnAllRanks(Mat matrix, const std::vector<PetscInt>& rows) {
    PetscInt columns = 0;
    check(MatGetSize(matrix, nullptr, &columns));
    IndexSet of_rows, of_columns;
    const auto count = static_cast<PetscInt>(rows.size());
    check(ISCreateGeneral(PETSC_COMM_SELF, count, rows.data(), PETSC_USE_POINTER, of_rows.out()));
    check(ISCreateStride(PETSC_COMM_SELF, columns, 0, 1, of_columns.out()));
    IS row = of_rows, column = of_columns;
    check(MatCreateSubMatrices(matrix, 1, &row, &column, MAT_INITIAL_MATRIX, &rows_));
  }
  ~RowsOnAllRanks() { (void)MatDestroySubMatrices(1, &rows_); }
  RowsOnAllRanks(const RowsOnAllRanks&) = delete;
  RowsOnAllRanks& operator=(const RowsOnAllRanks&) = delete;
  [[nodiscard]] RowView row(std::size_t n) const { return {rows_[0], static_cast<PetscInt>(n)}; }

 private:
  using IndexSet = petsc::Handle<IS, ISDestroy>;
  Mat* rows_ = nullptr;
};

/// The vectors of a matrix, whole on every rank.
class WholeVectors {
 public:
  /// Collective.
  explicit WholeVectors(Mat matrix) {
    VecHandle any;
    check(MatCreateVecs(matrix, nullptr, any.out()));
    check(VecScatterCreateToAll(any, scatter_.out(), all_.out()));
    check(VecGetOwnershipRange(any, &begin_, nullptr));
  }
  /// All entries of a vector. Collective.
  [[nodiscard]] std::vector<PetscScalar> gathered(Vec vec) const {
    check(VecScatterBegin(scatter_, vec, all_, INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(scatter_, vec, all_, INSERT_VALUES, SCATTER_FORWARD));
    const ReadView all(all_);
    return {all.data(), all.data() + all.size()};
  }
  /// Sets the entries of this rank to part(entry), for all of them on every rank. Local.
  template <class Scalar, class Part>
  void scatter(const Scalar* all, Vec vec, Part part) const {
    WriteView local(vec);
    for (PetscInt n = 0; n < local.size(); ++n) local[n] = part(all[begin_ + n]);
  }

 private:
  Handle<VecScatter, VecScatterDestroy> scatter_;
  VecHandle all_;
  PetscInt begin_ = 0;
};

/// Collective.
[[nodiscard]] inline VecHandle copy_of(Vec vec) {
  VecHandle copy;
  check(VecDuplicate(vec, copy.out()));
  check(VecCopy(vec, copy));
  return copy;
}

/// Entry by entry. Collective.
[[nodiscard]] inline VecHandle product(Vec a, Vec b) {
  VecHandle both = copy_of(a);
  check(VecPointwiseMult(both, a, b));
  return both;
}

/// Real part of sum_n a_n b_n, without conjugation. Collective.
[[nodiscard]] inline double dot(Vec a, Vec b) {
  PetscScalar sum = 0;
  check(VecTDot(a, b, &sum));
  return PetscRealPart(sum);
}

}  // namespace stickslip::petsc
