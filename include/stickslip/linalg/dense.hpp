#pragma once
/// Small dense linear algebra on BLAS and LAPACK, for double and std::complex<double>. Local.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace stickslip::linalg {

/// Column-major matrix.
template <class Scalar>
class Matrix {
 public:
  Matrix() = default;
  /// Zero.
  Matrix(int rows, int columns)
      : rows_(rows), columns_(columns), data_(static_cast<std::size_t>(rows) * columns, 0.0) {}
  [[nodiscard]] static Matrix identity(int n, Scalar value = 1) {
    Matrix result(n, n);
    for (int i = 0; i < n; ++i) result(i, i) = value;
    return result;
  }

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] Scalar& operator()(int r, int c) { return data_[at(r, c)]; }
  [[nodiscard]] Scalar operator()(int r, int c) const { return data_[at(r, c)]; }
  [[nodiscard]] Scalar* data() { return data_.data(); }
  [[nodiscard]] const Scalar* data() const { return data_.data(); }
  [[nodiscard]] Scalar* column(int c) { return data() + at(0, c); }
  [[nodiscard]] const Scalar* column(int c) const { return data() + at(0, c); }

  Matrix& operator+=(const Matrix& other) {
    for (std::size_t n = 0; n < data_.size(); ++n) data_[n] += other.data_[n];
    return *this;
  }
  Matrix& operator-=(const Matrix& other) {
    for (std::size_t n = 0; n < data_.size(); ++n) data_[n] -= other.data_[n];
    return *this;
  }
  Matrix& operator*=(Scalar factor) {
    for (Scalar& entry : data_) entry *= factor;
    return *this;
  }
  friend Matrix operator+(Matrix a, const Matrix& b) { return a += b; }
  friend Matrix operator-(Matrix a, const Matrix& b) { return a -= b; }
  friend Matrix operator*(Scalar factor, Matrix a) { return a *= factor; }
  /// Largest magnitude of an entry.
  [[nodiscard]] double largest() const {
    double size = 0;
    for (const Scalar& entry : data_) size = std::max(size, std::abs(entry));
    return size;
  }

 private:
  [[nodiscard]] std::size_t at(int r, int c) const {
    return static_cast<std::size_t>(c) * rows_ + r;
  }
  int rows_ = 0, columns_ = 0;
  std::vector<Scalar> data_;
};

/// Columns of a matrix, or some rows of them from the first one of these on.
template <class Scalar>
struct Columns {
  Scalar* first;
  int count = 1;
  int stride = 0;  ///< from one to the next

  [[nodiscard]] Scalar* column(int c) const {
    return first + static_cast<std::ptrdiff_t>(c) * stride;
  }
  /// The rows from one on. Without columns there may be no storage to point into.
  [[nodiscard]] Columns from(std::size_t row) const {
    return {count == 0 ? first : first + row, count, stride};
  }
};
template <class Scalar>
[[nodiscard]] Columns<Scalar> columns_of(Matrix<Scalar>& a) {
  return {a.data(), a.columns(), a.rows()};
}

/// C += factor A B for the first `columns` columns of B and C. O(rows(A) columns(A) columns).
template <class Scalar>
void add_product(std::type_identity_t<Scalar> factor, const Matrix<Scalar>& a,
                 const Matrix<Scalar>& b, int columns, Matrix<Scalar>& c);
/// y += A x, or A^T x. O(rows(A) columns(A)).
template <class Scalar>
void add_product(const Matrix<Scalar>& a, const std::type_identity_t<Scalar>* x,
                 std::type_identity_t<Scalar>* y, bool transposed = false);
/// Y += A X, or A^T X. O(rows(A) columns(A) columns(X)).
template <class Scalar>
void add_product(const Matrix<Scalar>& a, Columns<Scalar> x, Columns<Scalar> y, bool transposed);

template <class Scalar>
[[nodiscard]] Matrix<Scalar> operator*(const Matrix<Scalar>& a, const Matrix<Scalar>& b) {
  Matrix<Scalar> c(a.rows(), b.columns());
  add_product(1, a, b, b.columns(), c);
  return c;
}
/// A^T.
template <class Scalar>
[[nodiscard]] Matrix<Scalar> transposed(const Matrix<Scalar>& a) {
  Matrix<Scalar> t(a.columns(), a.rows());
  for (int c = 0; c < t.columns(); ++c) {
    for (int r = 0; r < t.rows(); ++r) t(r, c) = a(c, r);
  }
  return t;
}
/// A x for a column x.
template <class Scalar>
[[nodiscard]] std::vector<Scalar> operator*(const Matrix<Scalar>& a, const std::vector<Scalar>& x) {
  std::vector<Scalar> y(static_cast<std::size_t>(a.rows()), 0.0);
  add_product(a, x.data(), y.data());
  return y;
}
/// x A for a row x.
template <class Scalar>
[[nodiscard]] std::vector<Scalar> operator*(const std::vector<Scalar>& x, const Matrix<Scalar>& a) {
  std::vector<Scalar> y(static_cast<std::size_t>(a.columns()), 0.0);
  add_product(a, x.data(), y.data(), true);
  return y;
}
/// exp(M t) of a square matrix, by squaring a Taylor polynomial. O(size^3 log |M t|).
[[nodiscard]] Matrix<double> exponential(Matrix<double> m, double t);

/// LU factors of a square matrix with row interchanges (getrf).
template <class Scalar>
class LuFactors {
 public:
  LuFactors() = default;
  /// O(size^3). Throws NotReached when the matrix is singular.
  explicit LuFactors(Matrix<Scalar> a);

  [[nodiscard]] int size() const { return lu_.rows(); }
  /// B <- A^-1 B, or A^-T B. O(size^2 columns).
  void solve(Columns<Scalar> b, bool transposed) const;
  void solve(Matrix<Scalar>& b) const { solve(columns_of(b), false); }
  [[nodiscard]] Matrix<Scalar> solved(Matrix<Scalar> b) const {
    solve(b);
    return b;
  }
  /// x <- A^-1 x, or A^-T x. O(size^2).
  void solve(std::vector<Scalar>& x, bool transposed) const {
    solve(Columns<Scalar>{x.data()}, transposed);
  }

 private:
  Matrix<Scalar> lu_;
  std::vector<int> pivots_;
};

/// The x for which |A x - y| is least, A of full column rank with at least as many rows (gels).
/// O(rows columns^2). Throws NotReached when the rank is not full.
[[nodiscard]] std::vector<double> least_squares(Matrix<double> a, std::vector<double> y);

/// A = left diag(value) right^T for a square matrix, the largest values first (gesvd). O(n^3).
struct SingularValues {
  Matrix<double> left, right_transposed;
  std::vector<double> value;

  /// Throws NotReached when the iteration does not converge.
  explicit SingularValues(Matrix<double> a);
};

/// Complex Schur form A = Q T Q^H of a square matrix, T upper triangular (gees). O(n^3).
struct SchurForm {
  Matrix<std::complex<double>> q, t;

  /// Throws NotReached when the iteration does not converge.
  explicit SchurForm(const Matrix<double>& a);
};

/// Eigenvalues and right eigenvectors of norm 1, by columns, of a square matrix (geev). O(n^3).
struct Eigenvectors {
  std::vector<std::complex<double>> value;
  Matrix<std::complex<double>> right;

  /// Throws NotReached when the iteration does not converge.
  explicit Eigenvectors(Matrix<std::complex<double>> a);
};

/// Eigenvalues in rising order and orthonormal eigenvectors, by columns, of the symmetric matrix
/// with a diagonal of n entries and n - 1 entries beside it (stev). O(n^3).
struct TridiagonalEigen {
  std::vector<double> value;
  Matrix<double> vectors;

  /// Throws NotReached when the iteration does not converge.
  TridiagonalEigen(std::vector<double> diagonal, std::vector<double> beside);
};

// Gauss quadrature for discrete measures, and interpolation at its nodes.

/// The rule of n nodes for the weights w_i > 0 on the points x_1 < ... < x_m, m > n: exact for
/// polynomials of degree 2n - 1. The functions l_l of degree n - 1 with l_l(node_k) = delta_lk are
/// orthogonal in the scalar product of the weights, and their squares have the sums weight_l.
///
/// Orthogonal polynomials by Stieltjes' procedure with reorthogonalisation, nodes and weights from
/// the eigenvectors of their Jacobi matrix (Golub and Welsch). Local. O(m n^2).
class GaussRule {
 public:
  /// Throws std::invalid_argument unless 0 < size < points.size() == weights.size().
  GaussRule(std::span<const double> points, std::span<const double> weights, int size);

  [[nodiscard]] int size() const { return static_cast<int>(node.size()); }

  std::vector<double> node;    ///< rising
  std::vector<double> weight;  ///< their sum is that of the w_i
  /// l_l(x_i), m x n by rows.
  std::vector<double> cardinal;
  /// l_l(x_{i+1}) - l_l(x_i), (m - 1) x n by rows, from a recurrence of its own: no digits cancel
  /// where points are dense.
  std::vector<double> step;
};

// Chains given by rates: times, integrals and stationary probabilities without subtraction.

/// K - Q on the states 0 ... n-1 of a chain that jumps from state i to state j at the rate Q_ij and
/// is killed in state i at the rate K_i, factored once.
///
/// All members use the elimination of Grassmann, Taksar and Heyman on (jump rates, killing rates)
/// instead of (diagonal, off-diagonals): rates are only added, multiplied and divided, never
/// subtracted. Results have full relative accuracy in every entry, whatever the time scale, if what
/// they are asked about is >= 0. States are eliminated from the first one up: what is left on i,
/// i+1, ... is the chain watched there. Where jumps lead over at most b states memory is O(n b) and
/// time O(n b^2). Local.
///
/// Rates between nodes of a projection may be negative. Then LU factors of the matrix, of which the
/// diagonal is still the sum of all rates of leaving, take the place of the elimination.
class RateElimination {
 public:
  struct Rate {
    int from, to;
    double value;
  };
  /// Rates of killing by state, and of jumps. Throws std::invalid_argument where a state is neither
  /// left nor killed; the last state may be that if nothing at all is killed.
  RateElimination(std::vector<double> killing, const std::vector<Rate>& rates);

  [[nodiscard]] int size() const { return static_cast<int>(killing_.size()); }

  /// m with m (K - Q) = entry: mean time in each state of a chain that starts by `entry`.
  [[nodiscard]] std::vector<double> occupation(std::span<const double> entry) const;
  /// u with (K - Q) u = f: the mean integral of f until the chain is killed, by its first state.
  [[nodiscard]] std::vector<double> integral(std::vector<double> f) const;
  /// p with p Q = 0 and sum 1, where nothing is killed.
  [[nodiscard]] std::vector<double> stationary() const;

 private:
  void factor();
  [[nodiscard]] double& entry(int row, int column) { return rates_[at(row, column)]; }
  [[nodiscard]] double entry(int row, int column) const { return rates_[at(row, column)]; }
  [[nodiscard]] std::size_t at(int row, int column) const {
    const int place = column - row + band_;
    return static_cast<std::size_t>(row) * (2 * static_cast<std::size_t>(band_) + 1) +
           static_cast<std::size_t>(place);
  }
  [[nodiscard]] int last_of(int row) const;

  [[nodiscard]] Matrix<double> matrix() const;

  int band_ = 0;
  std::vector<double> killing_, rates_, pivot_;
  std::optional<LuFactors<double>> lu_;
};

}  // namespace stickslip::linalg
