#include "stickslip/exact/dense.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

// NOLINTBEGIN(readability-identifier-naming): the names of BLAS and LAPACK.
extern "C" {
void dgemm_(const char* transpose_a, const char* transpose_b, const int* m, const int* n,
            const int* k, const double* alpha, const double* a, const int* lda, const double* b,
            const int* ldb, const double* beta, double* c, const int* ldc);
void dgetrf_(const int* m, const int* n, double* a, const int* lda, int* pivots, int* info);
void dgetrs_(const char* transpose, const int* n, const int* columns, const double* a,
             const int* lda, const int* pivots, double* b, const int* ldb, int* info);
void dgesvd_(const char* left, const char* right, const int* m, const int* n, double* a,
             const int* lda, double* values, double* u, const int* ldu, double* vt, const int* ldvt,
             double* work, const int* work_size, int* info);
}
// NOLINTEND(readability-identifier-naming)

namespace stickslip::exact {

Matrix Matrix::identity(int n, double value) {
  Matrix result(n, n);
  for (int i = 0; i < n; ++i) result(i, i) = value;
  return result;
}

Matrix& Matrix::operator+=(const Matrix& other) {
  for (std::size_t n = 0; n < data_.size(); ++n) data_[n] += other.data_[n];
  return *this;
}

Matrix& Matrix::operator-=(const Matrix& other) {
  for (std::size_t n = 0; n < data_.size(); ++n) data_[n] -= other.data_[n];
  return *this;
}

Matrix& Matrix::operator*=(double factor) {
  for (double& entry : data_) entry *= factor;
  return *this;
}

double Matrix::largest() const {
  double size = 0;
  for (double entry : data_) size = std::max(size, std::abs(entry));
  return size;
}

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix c(a.rows(), b.columns());
  const int m = a.rows(), n = b.columns(), k = a.columns();
  const double one = 1, zero = 0;
  if (m > 0 && n > 0 && k > 0) {
    dgemm_("N", "N", &m, &n, &k, &one, a.data(), &m, b.data(), &k, &zero, c.data(), &m);
  }
  return c;
}

Matrix operator+(Matrix a, const Matrix& b) { return a += b; }
Matrix operator-(Matrix a, const Matrix& b) { return a -= b; }
Matrix operator*(double factor, Matrix a) { return a *= factor; }

std::vector<double> row_times(std::span<const double> x, const Matrix& m) {
  std::vector<double> result(static_cast<std::size_t>(m.columns()), 0.0);
  for (int c = 0; c < m.columns(); ++c) {
    for (int r = 0; r < m.rows(); ++r) result[c] += x[r] * m(r, c);
  }
  return result;
}

LuFactors::LuFactors(Matrix a) : lu_(std::move(a)), pivots_(static_cast<std::size_t>(lu_.rows())) {
  const int n = lu_.rows();
  int info = 0;
  if (n > 0) dgetrf_(&n, &n, lu_.data(), &n, pivots_.data(), &info);
  if (info != 0) throw std::runtime_error("a small dense matrix is singular");
}

Matrix LuFactors::solve(Matrix b) const {
  const int n = lu_.rows(), columns = b.columns();
  int info = 0;
  if (n > 0 && columns > 0) {
    dgetrs_("N", &n, &columns, lu_.data(), &n, pivots_.data(), b.data(), &n, &info);
  }
  return b;
}

std::vector<double> LuFactors::solve_row(std::vector<double> b) const {
  const int n = lu_.rows(), one = 1;
  int info = 0;
  if (n > 0) dgetrs_("T", &n, &one, lu_.data(), &n, pivots_.data(), b.data(), &n, &info);
  return b;
}

SingularValues::SingularValues(Matrix a)
    : left(a.rows(), a.rows()),
      right_transposed(a.rows(), a.rows()),
      value(static_cast<std::size_t>(a.rows())) {
  const int n = a.rows(), work_size = 64 * n;
  std::vector<double> work(static_cast<std::size_t>(work_size));
  int info = 0;
  if (n > 0) {
    dgesvd_("A", "A", &n, &n, a.data(), &n, value.data(), left.data(), &n, right_transposed.data(),
            &n, work.data(), &work_size, &info);
  }
  if (info != 0) throw std::runtime_error("the singular values of a matrix do not converge");
}

}  // namespace stickslip::exact
