#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "../common/catch.hpp"
#include "stickslip/quantities/engines/inversion.hpp"

using stickslip::linalg::LuFactors;
using stickslip::quantities::TransferFunction;
using Complex = std::complex<double>;
using Matrix = stickslip::linalg::Matrix<double>;

namespace {

// Grcar's matrix: eigenvalues far from what a rounding of the entries makes of them.
Matrix grcar(int n) {
  Matrix m(n, n);
  for (int r = 0; r < n; ++r) {
    for (int c = std::max(r - 1, 0); c < std::min(r + 4, n); ++c) m(r, c) = c < r ? -1 : 1;
  }
  return m;
}

// One Jordan block but for the last corner.
Matrix nearly_defective(int n, double corner) {
  Matrix m = Matrix::identity(n, -0.5);
  for (int r = 0; r + 1 < n; ++r) m(r, r + 1) = 1;
  m(n - 1, 0) = corner;
  return m;
}

// Rates from 1e-3 to 1e5, coupled one way by entries as large as the fastest.
Matrix stiff(int n) {
  Matrix m(n, n);
  for (int r = 0; r < n; ++r) {
    for (int c = r; c < n; ++c)
      m(r, c) = (r == c ? -1 : 0.3) * std::pow(10.0, 8.0 * c / (n - 1) - 3);
    if (r > 0) m(r, r - 1) = 1e-3;
  }
  return m;
}

std::vector<double> wave(int n, double frequency) {
  std::vector<double> x;
  for (int r = 0; r < n; ++r) x.push_back(1 + std::sin(frequency * (r + 1)));
  return x;
}

// left x, (z - M) x = right.
Complex dense(const Matrix& m, const std::vector<double>& left, const std::vector<double>& right,
              Complex z) {
  const int n = m.rows();
  auto a = stickslip::linalg::Matrix<Complex>::identity(n, z);
  for (int c = 0; c < n; ++c) {
    for (int r = 0; r < n; ++r) a(r, c) -= m(r, c);
  }
  std::vector<Complex> x(right.begin(), right.end());
  LuFactors(a).solve(x, false);
  return std::inner_product(x.begin(), x.end(), left.begin(), Complex(0));
}

double distance(Complex a, Complex b) { return std::abs(a - b) / std::abs(b); }

struct Sample {
  Matrix m;
  double tolerance;  // rounding, times how far the matrix is from normal
};

std::vector<Sample> samples() {
  return {{grcar(12), 1e-11}, {nearly_defective(9, 1e-3), 1e-11}, {stiff(15), 1e-11}};
}

}  // namespace

TEST_CASE("transfer function: dense solves at real and complex z, far from normal too") {
  for (const auto& [m, tolerance] : samples()) {
    const auto left = wave(m.rows(), 0.7), right = wave(m.rows(), 2.1);
    const TransferFunction h(m, left, right);
    for (const Complex z : {Complex(3), Complex(-7), Complex(0.2), Complex(0, 0.4), Complex(0, 5),
                            Complex(2, -1), Complex(-0.3, 30), Complex(40, 1e4)}) {
      INFO("size " << m.rows() << " z " << z);
      CHECK(distance(h(z), dense(m, left, right, z)) < tolerance);
    }
  }
}

TEST_CASE("transfer function: real on the real axis, conjugate across it") {
  for (const auto& [m, tolerance] : samples()) {
    const TransferFunction h(m, wave(m.rows(), 0.7), wave(m.rows(), 2.1));
    CHECK(std::abs(h(3.5).imag()) < tolerance * std::abs(h(3.5)));
    const Complex z(0.4, 2.5);
    CHECK(distance(std::conj(h(z)), h(std::conj(z))) < tolerance);
  }
}

// left right/z + left M right/z^2 + ...: far out nothing else is left.
TEST_CASE("transfer function: moments of the matrix at large z") {
  const int n = 12;
  const Matrix m = grcar(n);
  const auto left = wave(n, 0.7), right = wave(n, 2.1);
  const auto next = left * m;
  double first = 0, second = 0;
  for (int r = 0; r < n; ++r) {
    first += left[r] * right[r];
    second += next[r] * right[r];
  }
  const TransferFunction h(m, left, right);
  for (const Complex z : {Complex(0, 1e9), Complex(1e9), Complex(-3e9, 1e10)}) {
    CHECK(distance(h(z), first / z + second / (z * z)) < 1e-14);
  }
  CHECK(distance(h({0, 1e150}), Complex(0, -first * 1e-150)) < 1e-14);
}

TEST_CASE("transfer function: between other vectors as if made for them") {
  for (const auto& [m, tolerance] : samples()) {
    const auto left = wave(m.rows(), 1.3), right = wave(m.rows(), 0.2);
    const TransferFunction h(m, wave(m.rows(), 0.7), wave(m.rows(), 2.1));
    const TransferFunction other = h.between(left, right), made(m, left, right);
    for (const Complex z : {Complex(1.5), Complex(0, 3), Complex(-0.3, 1e3)}) {
      CHECK(other(z) == made(z));
      CHECK(distance(other(z), dense(m, left, right, z)) < tolerance);
    }
    // The one it came from stays as it was.
    const auto before = wave(m.rows(), 0.7), after = wave(m.rows(), 2.1);
    CHECK(distance(h({0, 3}), dense(m, before, after, {0, 3})) < tolerance);
  }
}

TEST_CASE("transfer function: one dimension by hand, infinite at the eigenvalue") {
  Matrix m(1, 1);
  m(0, 0) = 2;
  const TransferFunction h(m, {3}, {5});
  CHECK(h(5).real() == Approx(5).epsilon(1e-15));
  CHECK(distance(h({2, 1}), Complex(0, -15)) < 1e-15);
  CHECK_FALSE(std::isfinite(std::abs(h(2))));
}

TEST_CASE("transfer function: what is not a number has no Schur form") {
  Matrix m = grcar(4);
  m(1, 2) = std::nan("");
  CHECK_THROWS_AS(TransferFunction(m, wave(4, 1), wave(4, 1)), std::runtime_error);
}

TEST_CASE("transfer function: a model of size 0 is 0") {
  CHECK(TransferFunction(Matrix(0, 0), {}, {})({1, 2}) == Complex(0));
}
