#pragma once
/// Dense matrices of scalars on BLAS and LAPACK.

#include <petscsys.h>

#include <cstddef>
#include <vector>

namespace stickslip::petsc {

/// By columns.
class DenseMatrix {
 public:
  DenseMatrix() = default;
  /// Zero.
  DenseMatrix(int rows, int columns)
      : rows_(rows), columns_(columns), data_(static_cast<std::size_t>(rows) * columns, 0.0) {}

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] PetscScalar& operator()(int r, int c) { return data_[place(r, c)]; }
  [[nodiscard]] PetscScalar operator()(int r, int c) const { return data_[place(r, c)]; }
  [[nodiscard]] PetscScalar* data() { return data_.data(); }
  [[nodiscard]] const PetscScalar* data() const { return data_.data(); }
  [[nodiscard]] PetscScalar* column(int c) { return data() + place(0, c); }
  [[nodiscard]] const PetscScalar* column(int c) const { return data() + place(0, c); }

 private:
  [[nodiscard]] std::size_t place(int r, int c) const {
    return static_cast<std::size_t>(c) * rows_ + r;
  }
  int rows_ = 0, columns_ = 0;
  std::vector<PetscScalar> data_;
};

/// C += factor A B for the first `columns` columns of B and C.
void add_product(PetscScalar factor, const DenseMatrix& a, const DenseMatrix& b, int columns,
                 DenseMatrix& c);
[[nodiscard]] DenseMatrix operator*(const DenseMatrix& a, const DenseMatrix& b);

using Scalars = std::vector<PetscScalar>;
/// y += A x, or A^T x.
void add_product(const DenseMatrix& a, const Scalars& x, Scalars& y, bool transposed = false);

/// LU factors of a square matrix with exchanges of rows.
class DenseFactors {
 public:
  DenseFactors() = default;
  /// O(size^3). Throws NotReached if the matrix is singular.
  explicit DenseFactors(DenseMatrix a);

  [[nodiscard]] int size() const { return lu_.rows(); }
  /// B <- A^-1 B. O(size^2 columns).
  void solve(DenseMatrix& b) const;
  /// x <- A^-1 x, or A^-T x.
  void solve(PetscScalar* x, bool transposed) const;
  void solve(Scalars& x, bool transposed) const { solve(x.data(), transposed); }

 private:
  DenseMatrix lu_;
  std::vector<PetscBLASInt> pivots_;
};

}  // namespace stickslip::petsc
