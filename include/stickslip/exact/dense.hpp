#pragma once
/// Dense matrices of moderate size on BLAS and LAPACK.

#include <cstddef>
#include <span>
#include <vector>

namespace stickslip::exact {

/// Column-major matrix of doubles.
class Matrix {
 public:
  Matrix() = default;
  Matrix(int rows, int columns)
      : rows_(rows), columns_(columns), data_(static_cast<std::size_t>(rows) * columns, 0.0) {}
  [[nodiscard]] static Matrix identity(int n, double value = 1);

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] double& operator()(int r, int c) { return data_[at(r, c)]; }
  [[nodiscard]] double operator()(int r, int c) const { return data_[at(r, c)]; }
  [[nodiscard]] double* data() { return data_.data(); }
  [[nodiscard]] const double* data() const { return data_.data(); }

  Matrix& operator+=(const Matrix& other);
  Matrix& operator-=(const Matrix& other);
  Matrix& operator*=(double factor);
  /// Largest absolute entry.
  [[nodiscard]] double largest() const;

 private:
  [[nodiscard]] std::size_t at(int r, int c) const {
    return static_cast<std::size_t>(c) * rows_ + r;
  }
  int rows_ = 0, columns_ = 0;
  std::vector<double> data_;
};

[[nodiscard]] Matrix operator*(const Matrix& a, const Matrix& b);
[[nodiscard]] Matrix operator+(Matrix a, const Matrix& b);
[[nodiscard]] Matrix operator-(Matrix a, const Matrix& b);
[[nodiscard]] Matrix operator*(double factor, Matrix a);
/// x M for a row x.
[[nodiscard]] std::vector<double> row_times(std::span<const double> x, const Matrix& m);

/// LU factors of a square matrix with row interchanges (dgetrf). O(n^3).
class LuFactors {
 public:
  /// Throws std::runtime_error when the matrix is singular.
  explicit LuFactors(Matrix a);
  /// A^-1 B.
  [[nodiscard]] Matrix solve(Matrix b) const;
  /// x with x A = b.
  [[nodiscard]] std::vector<double> solve_row(std::vector<double> b) const;

 private:
  Matrix lu_;
  std::vector<int> pivots_;
};

/// A = left diag(value) right^T for a square matrix, the largest values first (dgesvd). O(n^3).
struct SingularValues {
  Matrix left, right_transposed;
  std::vector<double> value;

  /// Throws std::runtime_error when the iteration does not converge.
  explicit SingularValues(Matrix a);
};

}  // namespace stickslip::exact
