#include "stickslip/linalg/dense.hpp"

#include <array>
#include <cstdlib>
#include <numeric>
#include <stdexcept>

#include "stickslip/base/errors.hpp"

namespace {

using Complex = std::complex<double>;

// Signatures by scalar type.
template <class S>
using Gemm = void(const char* transpose_a, const char* transpose_b, const int* m, const int* n,
                  const int* k, const S* alpha, const S* a, const int* lda, const S* b,
                  const int* ldb, const S* beta, S* c, const int* ldc);
template <class S>
using Gemv = void(const char* transpose, const int* m, const int* n, const S* alpha, const S* a,
                  const int* lda, const S* x, const int* step_x, const S* beta, S* y,
                  const int* step_y);
template <class S>
using Getrf = void(const int* m, const int* n, S* a, const int* lda, int* pivots, int* info);
template <class S>
using Getrs = void(const char* transpose, const int* n, const int* columns, const S* a,
                   const int* lda, const int* pivots, S* b, const int* ldb, int* info);

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): the names of BLAS and LAPACK.
extern "C" {
Gemm<double> dgemm_;
Gemm<Complex> zgemm_;
Gemv<double> dgemv_;
Gemv<Complex> zgemv_;
Getrf<double> dgetrf_;
Getrf<Complex> zgetrf_;
Getrs<double> dgetrs_;
Getrs<Complex> zgetrs_;
void dgels_(const char* transpose, const int* m, const int* n, const int* columns, double* a,
            const int* lda, double* b, const int* ldb, double* work, const int* work_size,
            int* info);
void dgesvd_(const char* left, const char* right, const int* m, const int* n, double* a,
             const int* lda, double* values, double* u, const int* ldu, double* vt, const int* ldvt,
             double* work, const int* work_size, int* info);
void zgees_(const char* vectors, const char* sort, int (*select)(const Complex*), const int* n,
            Complex* a, const int* lda, int* selected, Complex* w, Complex* q, const int* ldq,
            Complex* work, const int* work_size, double* real_work, int* flags, int* info);
void zgeev_(const char* left, const char* right, const int* n, Complex* a, const int* lda,
            Complex* w, Complex* vl, const int* ldvl, Complex* vr, const int* ldvr, Complex* work,
            const int* work_size, double* real_work, int* info);
void dstev_(const char* vectors, const int* n, double* diagonal, double* beside, double* z,
            const int* ldz, double* work, int* info);
}

namespace stickslip::linalg {
namespace {

template <class Scalar>
struct Routines;
template <>
struct Routines<double> {
  static constexpr auto gemm = dgemm_;
  static constexpr auto gemv = dgemv_;
  static constexpr auto getrf = dgetrf_;
  static constexpr auto getrs = dgetrs_;
};
template <>
struct Routines<Complex> {
  static constexpr auto gemm = zgemm_;
  static constexpr auto gemv = zgemv_;
  static constexpr auto getrf = zgetrf_;
  static constexpr auto getrs = zgetrs_;
};
// NOLINTEND(readability-identifier-naming)

void expect_success(int info, const char* complaint) {
  if (info != 0) throw NotReached(complaint);
}

// Up to these sizes the loops below take less time than a call of BLAS.
constexpr int kSmallSystem = 96, kFewColumns = 16;
constexpr int kAtOnce = 4;  // columns

template <int count>
using Factors = std::array<double, count>;

// y += A f, A with `count` columns from a on: the loop over rows goes to vectors of the processor.
template <int count>
void add_columns(int rows, const double* a, int stride, Factors<count> f, double* y) {
  for (int r = 0; r < rows; ++r) {
    double sum = 0;
    for (int c = 0; c < count; ++c) sum += a[c * stride + r] * f[c];
    y[r] += sum;
  }
}

void add_small_product(const Matrix<double>& a, const double* x, double* y) {
  int c = 0;
  for (; c + kAtOnce <= a.columns(); c += kAtOnce) {
    add_columns<kAtOnce>(a.rows(), a.column(c), a.rows(), {x[c], x[c + 1], x[c + 2], x[c + 3]}, y);
  }
  for (; c < a.columns(); ++c) add_columns<1>(a.rows(), a.column(c), a.rows(), {x[c]}, y);
}

// The columns of L from `begin` on. Their part of x stays in registers: what is stored by single
// numbers is slow to load as a vector.
template <int count>
void eliminate_lower(const Matrix<double>& lu, int begin, double* x) {
  Factors<count> f;
  const double* a = lu.column(begin) + begin;
  const int stride = lu.rows();
  for (int c = 0; c < count; ++c) f[c] = -x[begin + c];
  for (int c = 0; c < count; ++c) {
    for (int r = c + 1; r < count; ++r) f[r] -= a[c * stride + r] * f[c];
  }
  for (int c = 0; c < count; ++c) x[begin + c] = -f[c];
  const int end = begin + count;
  add_columns<count>(stride - end, a + count, stride, f, x + end);
}

// The same for U.
template <int count>
void eliminate_upper(const Matrix<double>& lu, int begin, double* x) {
  Factors<count> f;
  const double* a = lu.column(begin) + begin;
  const int stride = lu.rows();
  for (int c = 0; c < count; ++c) f[c] = -x[begin + c];
  for (int c = count; c-- > 0;) {
    f[c] /= a[c * stride + c];
    for (int r = 0; r < c; ++r) f[r] -= a[c * stride + r] * f[c];
  }
  for (int c = 0; c < count; ++c) x[begin + c] = -f[c];
  add_columns<count>(begin, a - begin, stride, f, x);
}

// P A = L U as getrf leaves it: the unit diagonal of L left out, row exchanges counted from 1.
void solve_small(const Matrix<double>& lu, const std::vector<int>& exchanges, double* x) {
  const int n = lu.rows(), rest = n % kAtOnce;
  for (int r = 0; r < n; ++r) std::swap(x[r], x[exchanges[r] - 1]);
  for (int c = 0; c < n - rest; c += kAtOnce) eliminate_lower<kAtOnce>(lu, c, x);
  for (int c = n - rest; c < n; ++c) eliminate_lower<1>(lu, c, x);
  for (int c = n; c-- > n - rest;) eliminate_upper<1>(lu, c, x);
  for (int c = n - rest; (c -= kAtOnce) >= 0;) eliminate_upper<kAtOnce>(lu, c, x);
}

using Column = std::vector<double>;

/// Polynomials p_0 ... p_(n-1), orthonormal for normalised weights, with their recurrence
///
///   b_(j+1) p_(j+1) = (t - a_j) p_j - b_j p_(j-1).
class OrthogonalPolynomials {
 public:
  OrthogonalPolynomials(std::span<const double> t, std::span<const double> w, int size)
      : t_(t), w_(w), off_diagonal(1, 0.0) {
    value.emplace_back(t.size(), 1.0);
    for (int j = 0; j < size; ++j) {
      Column next(t.size());
      for (std::size_t i = 0; i < next.size(); ++i) next[i] = t[i] * value[j][i];
      diagonal.push_back(product(next, value[j]));
      if (j + 1 == size) break;
      for (int pass = 0; pass < 2; ++pass) orthogonalise(next);
      const double norm = std::sqrt(product(next, next));
      for (double& entry : next) entry /= norm;
      off_diagonal.push_back(norm);
      value.push_back(std::move(next));
    }
  }

  // p_j(t_(i+1)) - p_j(t_i), by the differences of the recurrence.
  [[nodiscard]] std::vector<Column> steps() const {
    const std::size_t count = t_.size() - 1, size = value.size();
    std::vector<Column> step(size, Column(count, 0.0));
    for (std::size_t j = 0; j + 1 < size; ++j) {
      for (std::size_t i = 0; i < count; ++i) {
        const double before = j == 0 ? 0 : off_diagonal[j] * step[j - 1][i];
        step[j + 1][i] =
            ((t_[i + 1] - diagonal[j]) * step[j][i] + (t_[i + 1] - t_[i]) * value[j][i] - before) /
            off_diagonal[j + 1];
      }
    }
    return step;
  }

 private:
  std::span<const double> t_, w_;

 public:
  std::vector<Column> value;  // p_j(t_i)
  Column diagonal, off_diagonal;

 private:
  [[nodiscard]] double product(const Column& x, const Column& y) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += w_[i] * x[i] * y[i];
    return sum;
  }

  void orthogonalise(Column& next) const {
    for (const Column& p : value) {
      const double part = product(next, p);
      for (std::size_t i = 0; i < next.size(); ++i) next[i] -= part * p[i];
    }
  }
};

// Points and weights scaled such that neither overflows: t in [-1, 1], weights of sum 1.
Column scaled(std::span<const double> x, double shift, double factor) {
  Column result;
  for (double value : x) result.push_back((value - shift) * factor);
  return result;
}

// Rows of sum_j p_j(x) vector_jl scale_l.
std::vector<double> combined(const std::vector<Column>& p, const Matrix<double>& vectors,
                             const Column& scale) {
  const std::size_t rows = p.front().size();
  const int n = vectors.rows();
  std::vector<double> result(rows * p.size(), 0.0);
  for (std::size_t i = 0; i < rows; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int l = 0; l < n; ++l) result[i * n + l] += p[j][i] * vectors(j, l) * scale[l];
    }
  }
  return result;
}

}  // namespace

template <class Scalar>
void add_product(std::type_identity_t<Scalar> factor, const Matrix<Scalar>& a,
                 const Matrix<Scalar>& b, int columns, Matrix<Scalar>& c) {
  const int m = a.rows(), n = columns, k = a.columns(), ldb = b.rows(), ldc = c.rows();
  if (m == 0 || n == 0 || k == 0) return;
  const Scalar one = 1;
  Routines<Scalar>::gemm("N", "N", &m, &n, &k, &factor, a.data(), &m, b.data(), &ldb, &one,
                         c.data(), &ldc);
}

template <class Scalar>
void add_product(const Matrix<Scalar>& a, const std::type_identity_t<Scalar>* x,
                 std::type_identity_t<Scalar>* y, bool transposed) {
  const int m = a.rows(), n = a.columns(), step = 1;
  if (m == 0 || n == 0) return;
  if constexpr (std::is_same_v<Scalar, double>) {
    if (!transposed && n <= kFewColumns) return add_small_product(a, x, y);
  }
  const Scalar one = 1;
  Routines<Scalar>::gemv(transposed ? "T" : "N", &m, &n, &one, a.data(), &m, x, &step, &one, y,
                         &step);
}

template <class Scalar>
void add_product(const Matrix<Scalar>& a, Columns<Scalar> x, Columns<Scalar> y, bool transposed) {
  if (x.count == 1) return add_product(a, x.first, y.first, transposed);
  const int lda = a.rows(), m = transposed ? a.columns() : lda, k = transposed ? lda : a.columns();
  if (m == 0 || x.count == 0 || k == 0) return;
  const Scalar one = 1;
  Routines<Scalar>::gemm(transposed ? "T" : "N", "N", &m, &x.count, &k, &one, a.data(), &lda,
                         x.first, &x.stride, &one, y.first, &y.stride);
}

template <class Scalar>
LuFactors<Scalar>::LuFactors(Matrix<Scalar> a)
    : lu_(std::move(a)), pivots_(static_cast<std::size_t>(lu_.rows())) {
  const int n = size();
  int info = 0;
  if (n > 0) Routines<Scalar>::getrf(&n, &n, lu_.data(), &n, pivots_.data(), &info);
  expect_success(info, "the factorisation met a singular block");
}

template <class Scalar>
void LuFactors<Scalar>::solve(Columns<Scalar> b, bool transposed) const {
  const int n = size();
  if (n == 0 || b.count == 0) return;
  if constexpr (std::is_same_v<Scalar, double>) {
    if (!transposed && b.count == 1 && n <= kSmallSystem) {
      return solve_small(lu_, pivots_, b.first);
    }
  }
  const int stride = b.count == 1 ? n : b.stride;
  int info = 0;  // nothing but wrong arguments
  Routines<Scalar>::getrs(transposed ? "T" : "N", &n, &b.count, lu_.data(), &n, pivots_.data(),
                          b.first, &stride, &info);
}

template class LuFactors<double>;
template class LuFactors<Complex>;
template void add_product(double, const Matrix<double>&, const Matrix<double>&, int,
                          Matrix<double>&);
template void add_product(Complex, const Matrix<Complex>&, const Matrix<Complex>&, int,
                          Matrix<Complex>&);
template void add_product(const Matrix<double>&, const double*, double*, bool);
template void add_product(const Matrix<Complex>&, const Complex*, Complex*, bool);
template void add_product(const Matrix<double>&, Columns<double>, Columns<double>, bool);
template void add_product(const Matrix<Complex>&, Columns<Complex>, Columns<Complex>, bool);

Matrix<double> exponential(Matrix<double> m, double t) {
  m *= t;
  int squarings = 0;
  for (double size = m.rows() * m.largest(); size > 0.5; size /= 2) ++squarings;
  m *= std::exp2(-squarings);
  // Horner: 1 + M (1 + M/2 (1 + M/3 (...))).
  const auto one = Matrix<double>::identity(m.rows());
  auto sum = one;
  for (int n = 15; n >= 1; --n) sum = 1.0 / n * (m * sum) + one;
  for (int n = 0; n < squarings; ++n) sum = sum * sum;
  return sum;
}

std::vector<double> least_squares(Matrix<double> a, std::vector<double> y) {
  const int rows = a.rows(), n = a.columns(), one = 1, work_size = 64 * (n + 1);
  std::vector<double> work(static_cast<std::size_t>(work_size));
  int info = 0;
  dgels_("N", &rows, &n, &one, a.data(), &rows, y.data(), &rows, work.data(), &work_size, &info);
  expect_success(info, "the columns of a least squares problem depend on each other");
  y.resize(static_cast<std::size_t>(n));
  return y;
}

SingularValues::SingularValues(Matrix<double> a)
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
  expect_success(info, "the singular values of a matrix do not converge");
}

SchurForm::SchurForm(const Matrix<double>& a) : q(a.rows(), a.rows()), t(a.rows(), a.rows()) {
  const int n = a.rows(), work_size = 64 * n + 1;
  std::copy(a.data(), a.column(n), t.data());
  std::vector<Complex> values(static_cast<std::size_t>(n)), work(64 * values.size() + 1);
  std::vector<double> real_work(values.size());
  int selected = 0, info = 0;
  if (n > 0) {
    zgees_("V", "N", nullptr, &n, t.data(), &n, &selected, values.data(), q.data(), &n, work.data(),
           &work_size, real_work.data(), nullptr, &info);
  }
  expect_success(info, "the Schur form of a matrix does not converge");
}

Eigenvectors::Eigenvectors(Matrix<Complex> a)
    : value(static_cast<std::size_t>(a.rows())), right(a.rows(), a.rows()) {
  const int n = a.rows(), work_size = 4 * n, one = 1;
  std::vector<Complex> work(4 * value.size());
  std::vector<double> real_work(2 * value.size());
  Complex none;
  int info = 0;
  if (n > 0) {
    zgeev_("N", "V", &n, a.data(), &n, value.data(), &none, &one, right.data(), &n, work.data(),
           &work_size, real_work.data(), &info);
  }
  expect_success(info, "the eigenvalues of a matrix do not converge");
}

TridiagonalEigen::TridiagonalEigen(std::vector<double> diagonal, std::vector<double> beside)
    : value(std::move(diagonal)) {
  const int n = static_cast<int>(value.size());
  vectors = Matrix<double>(n, n);
  std::vector<double> work(2 * value.size());
  int info = 0;
  if (n > 0) {
    dstev_("V", &n, value.data(), beside.data(), vectors.data(), &n, work.data(), &info);
  }
  expect_success(info, "the eigenvalues of a tridiagonal matrix do not converge");
}

GaussRule::GaussRule(std::span<const double> points, std::span<const double> weights, int size) {
  if (size < 1 || points.size() != weights.size() ||
      points.size() <= static_cast<std::size_t>(size)) {
    throw std::invalid_argument("a Gauss rule needs more points than nodes");
  }
  double total = 0;
  for (double w : weights) total += w;
  const double middle = (points.front() + points.back()) / 2;
  const double half = (points.back() - points.front()) / 2;
  const Column t = scaled(points, middle, 1 / half), w = scaled(weights, 0, 1 / total);
  const OrthogonalPolynomials p(t, w, size);
  TridiagonalEigen eigen(p.diagonal, {p.off_diagonal.begin() + 1, p.off_diagonal.end()});
  node = std::move(eigen.value);
  // p_0 = 1, so that the first entry of an eigenvector is the root of its weight.
  Column root(node.size());
  for (int l = 0; l < size; ++l) {
    root[l] = eigen.vectors(0, l);
    weight.push_back(total * root[l] * root[l]);
    node[l] = middle + half * node[l];
  }
  cardinal = combined(p.value, eigen.vectors, root);
  step = combined(p.steps(), eigen.vectors, root);
}

RateElimination::RateElimination(std::vector<double> killing, const std::vector<Rate>& rates)
    : killing_(std::move(killing)) {
  for (const auto& [from, to, value] : rates) band_ = std::max(band_, std::abs(to - from));
  rates_.resize(killing_.size() * (2 * static_cast<std::size_t>(band_) + 1));
  for (const auto& [from, to, value] : rates) entry(from, to) += value;
  const auto negative = [](double rate) { return rate < 0; };
  if (std::ranges::none_of(rates_, negative) && std::ranges::none_of(killing_, negative)) {
    factor();
  } else if (std::ranges::any_of(killing_, [](double rate) { return rate != 0; })) {
    lu_.emplace(matrix());
  }
}

// K - Q.
Matrix<double> RateElimination::matrix() const {
  Matrix<double> a(size(), size());
  for (int i = 0; i < size(); ++i) {
    a(i, i) += killing_[i];
    for (int k = std::max(i - band_, 0); k <= last_of(i); ++k) {
      a(i, k) -= entry(i, k);
      a(i, i) += entry(i, k);
    }
  }
  return a;
}

int RateElimination::last_of(int row) const { return std::min(row + band_, size() - 1); }

// The pivot of a state is the rate at which the watched chain leaves it: to states above, or
// killed.
void RateElimination::factor() {
  pivot_.assign(killing_.size(), 0.0);
  for (int i = 0; i < size(); ++i) {
    const int last = last_of(i);
    double pivot = killing_[i];
    for (int k = i + 1; k <= last; ++k) pivot += entry(i, k);
    pivot_[i] = pivot;
    if (!(pivot > 0)) {
      if (i + 1 == size()) return;
      throw std::invalid_argument("a state is never left");
    }
    for (int j = i + 1; j <= last; ++j) {
      const double back = entry(j, i);
      if (back == 0) continue;
      killing_[j] += back * killing_[i] / pivot;
      for (int k = i + 1; k <= last; ++k) {
        if (k != j) entry(j, k) += back * entry(i, k) / pivot;
      }
    }
  }
}

std::vector<double> RateElimination::occupation(std::span<const double> entry_law) const {
  if (entry_law.size() != killing_.size()) {
    throw std::invalid_argument("a distribution of a wrong size");
  }
  std::vector<double> m(entry_law.begin(), entry_law.end());
  if (lu_) {
    lu_->solve(m, true);
    return m;
  }
  for (int i = 0; i < size(); ++i) {
    for (int k = i + 1; k <= last_of(i); ++k) m[k] += m[i] * entry(i, k) / pivot_[i];
  }
  for (int i = size() - 1; i >= 0; --i) {
    for (int k = i + 1; k <= last_of(i); ++k) m[i] += m[k] * entry(k, i);
    m[i] /= pivot_[i];
  }
  return m;
}

std::vector<double> RateElimination::integral(std::vector<double> f) const {
  if (f.size() != killing_.size()) throw std::invalid_argument("a function of a wrong size");
  if (lu_) {
    lu_->solve(f, false);
    return f;
  }
  for (int i = 0; i < size(); ++i) {
    for (int k = i + 1; k <= last_of(i); ++k) f[k] += entry(k, i) * f[i] / pivot_[i];
  }
  for (int i = size() - 1; i >= 0; --i) {
    for (int k = i + 1; k <= last_of(i); ++k) f[i] += entry(i, k) * f[k];
    f[i] /= pivot_[i];
  }
  return f;
}

std::vector<double> RateElimination::stationary() const {
  std::vector<double> p(killing_.size(), 0.0);
  if (p.empty()) return p;
  p.back() = 1;
  if (pivot_.empty()) {
    auto a = matrix();
    for (int i = 0; i < size(); ++i) a(i, size() - 1) = 1;
    LuFactors<double>(std::move(a)).solve(p, true);
    return p;
  }
  for (int i = size() - 2; i >= 0; --i) {
    for (int k = i + 1; k <= last_of(i); ++k) p[i] += p[k] * entry(k, i);
    p[i] /= pivot_[i];
    // Far from the last state weights may be beyond the range of numbers.
    constexpr double large = 1e200;
    if (p[i] < large) continue;
    for (double& value : p) value /= large;
  }
  const double total = std::accumulate(p.begin(), p.end(), 0.0);
  for (double& value : p) value /= total;
  return p;
}

}  // namespace stickslip::linalg
