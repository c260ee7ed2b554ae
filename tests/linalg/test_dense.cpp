#include <cmath>
#include <complex>

#include "../common/catch.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/linalg/dense.hpp"

using stickslip::NotReached;
using stickslip::linalg::exponential;
using stickslip::linalg::least_squares;
using stickslip::linalg::LuFactors;
using stickslip::linalg::SingularValues;
using Complex = std::complex<double>;
using Matrix = stickslip::linalg::Matrix<double>;

namespace {

Matrix sample(int rows, int columns) {
  Matrix m(rows, columns);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) m(r, c) = 1.0 / (1 + r + 2 * c) + (r == c ? 1 : 0);
  }
  return m;
}

}  // namespace

TEST_CASE("dense: products by hand") {
  Matrix a(1, 2), b(2, 2);
  a(0, 0) = 1;
  a(0, 1) = 2;
  b(0, 0) = 3;
  b(0, 1) = 4;
  b(1, 0) = 5;
  b(1, 1) = 6;
  const Matrix c = a * b;
  CHECK(c(0, 0) == 13);
  CHECK(c(0, 1) == 16);
  CHECK(std::vector<double>{1, 2} * b == std::vector<double>{13, 16});
  CHECK(b * std::vector<double>{1, 2} == std::vector<double>{11, 17});
  CHECK((a + a - a).largest() == 2);
}

TEMPLATE_TEST_CASE("dense: factors solve from both sides", "", double, Complex) {
  stickslip::linalg::Matrix<TestType> a(5, 5), b(5, 3);
  const Matrix part = sample(5, 5);
  TestType turn = 1;
  if constexpr (std::is_same_v<TestType, Complex>) turn = {0.6, 0.8};
  for (int c = 0; c < 5; ++c) {
    for (int r = 0; r < 5; ++r) a(r, c) = part(r, c) * (r > c ? turn : TestType(1));
    if (c < 3) std::copy(a.column(c), a.column(c + 1), b.column(c));
  }
  b *= turn;
  const LuFactors factors(a);
  CHECK((a * factors.solved(b) - b).largest() < 1e-14);
  const std::vector<TestType> row{1, -2, turn, 0, 5};
  std::vector<TestType> from_left = row, from_right = row;
  factors.solve(from_left, true);
  factors.solve(from_right, false);
  const auto left = from_left * a, right = a * from_right;
  for (int n = 0; n < 5; ++n) {
    CHECK(std::abs(left[n] - row[n]) < 1e-14);
    CHECK(std::abs(right[n] - row[n]) < 1e-14);
  }
}

// Rows 1 to 3 of columns of five, by the products and factors of one column.
TEMPLATE_TEST_CASE("dense: some rows of several columns", "", double, Complex) {
  using Columns = stickslip::linalg::Columns<TestType>;
  for (const bool transposed : {false, true}) {
    for (const int count : {0, 1, 2, 20}) {
      INFO((transposed ? "transposed, " : "") << count << " columns");
      stickslip::linalg::Matrix<TestType> a(3, 3), x(5, count), solved(5, count), image(5, count);
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) a(r, c) = sample(3, 3)(r, c) * (r > c ? 2.0 : -1.0);
      }
      for (int c = 0; c < count; ++c) {
        for (int r = 0; r < 5; ++r) x(r, c) = solved(r, c) = 1.0 / (2 + r + 5 * c) - r;
      }
      LuFactors(a).solve(columns_of(solved).from(1), transposed);
      stickslip::linalg::add_product(a, columns_of(solved).from(1), columns_of(image).from(1),
                                     transposed);
      for (int c = 0; c < count; ++c) {
        for (int r : {0, 4}) CHECK((solved(r, c) == x(r, c) && image(r, c) == TestType(0)));
        for (int r : {1, 2, 3}) CHECK(std::abs(image(r, c) - x(r, c)) < 1e-13);
        CHECK(Columns(columns_of(x)).column(c) == x.column(c));
      }
    }
  }
}

// On both sides of the sizes up to which loops take the place of BLAS, and of its blocks.
TEST_CASE("dense: products and solutions of all sizes") {
  for (int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 94, 95, 96, 97, 98}) {
    const Matrix part = sample(n, n);
    Matrix a(n, n);
    std::vector<double> x(static_cast<std::size_t>(n)), b(x);
    for (int c = 0; c < n; ++c) {
      for (int r = 0; r < n; ++r) a(r, c) = part(n - 1 - r, c);  // rows to be exchanged
      x[c] = c % 7 - 3;
      for (int r = 0; r < n; ++r) b[r] += a(r, c) * x[c];
    }
    const auto product = a * x;
    auto solved = b;
    LuFactors(a).solve(solved, false);
    INFO("size " << n);
    for (int r = 0; r < n; ++r) {
      CHECK(std::abs(product[r] - b[r]) < 1e-12);
      CHECK(std::abs(solved[r] - x[r]) < 1e-9);
    }
  }
}

TEST_CASE("dense: singular matrices are refused, empty ones are fine") {
  CHECK_THROWS_AS(LuFactors(Matrix(2, 2)), NotReached);
  CHECK_NOTHROW(LuFactors(Matrix(0, 0)));
}

TEST_CASE("dense: singular values put a matrix together again") {
  const Matrix a = sample(5, 5);
  const SingularValues s(a);
  Matrix scaled = s.left;
  for (int c = 0; c < 5; ++c) {
    if (c > 0) CHECK(s.value[c] <= s.value[c - 1]);
    for (int r = 0; r < 5; ++r) scaled(r, c) *= s.value[c];
  }
  CHECK((scaled * s.right_transposed - a).largest() < 1e-14);
}

TEST_CASE("dense: singular values of singular and of empty matrices") {
  Matrix golden(3, 3);  // rows (1, 1, 0), (1, 0, 0), 0
  golden(0, 0) = golden(0, 1) = golden(1, 0) = 1;
  const SingularValues s(golden);
  CHECK(s.value[0] == Approx(1.6180339887498949).epsilon(1e-14));
  CHECK(s.value[1] == Approx(0.6180339887498949).epsilon(1e-14));
  CHECK(s.value[2] < 1e-15);
  CHECK(SingularValues(Matrix(0, 0)).value.empty());
}

TEST_CASE("dense: exponentials of a rotation, and of what has one eigenvector alone") {
  Matrix turn(2, 2), block(2, 2);
  turn(0, 1) = -3;
  turn(1, 0) = 3;
  const auto turned = exponential(turn, 2);
  CHECK(turned(0, 0) == Approx(std::cos(6)).epsilon(1e-12));
  CHECK(turned(1, 0) == Approx(std::sin(6)).epsilon(1e-12));
  block(0, 0) = block(1, 1) = -2;
  block(0, 1) = 5;
  const auto grown = exponential(block, 1.5);
  CHECK(grown(0, 0) == Approx(std::exp(-3)).epsilon(1e-13));
  CHECK(grown(0, 1) == Approx(7.5 * std::exp(-3)).epsilon(1e-13));
  CHECK(grown(1, 0) == 0);
}

TEST_CASE("dense: least squares leave what is orthogonal to the columns") {
  // A line through (0, 1), (1, 3), (2, 4), (3, 4): 1.5 + x.
  Matrix a(4, 2);
  std::vector<double> y{1, 3, 4, 4};
  for (int n = 0; n < 4; ++n) {
    a(n, 0) = 1;
    a(n, 1) = n;
  }
  const auto x = least_squares(a, y);
  REQUIRE(x.size() == 2);
  CHECK(x[0] == Approx(1.5).epsilon(1e-14));
  CHECK(x[1] == Approx(1).epsilon(1e-14));
  for (int n = 0; n < 4; ++n) a(n, 1) = 0;
  CHECK_THROWS_AS(least_squares(a, y), NotReached);
}

TEST_CASE("dense: the largest entry counts by its size") {
  Matrix m(2, 2);
  m(0, 1) = -5;
  m(1, 0) = 3;
  CHECK(m.largest() == 5);
}

// [1, a; b, 1] has the eigenvalues 1 +- (a b)^1/2 with vectors (a^1/2, +-b^1/2).
TEST_CASE("dense: eigenvectors of a complex matrix") {
  stickslip::linalg::Matrix<Complex> a(2, 2);
  a(0, 0) = a(1, 1) = 1;
  a(0, 1) = Complex(0, 4);
  a(1, 0) = 1;
  const stickslip::linalg::Eigenvectors modes(a);
  for (int n = 0; n < 2; ++n) {
    const Complex root = modes.value[n] - 1.0;
    CHECK(std::abs(root * root - Complex(0, 4)) < 1e-14);
    CHECK(std::abs(modes.right(0, n) - root * modes.right(1, n)) < 1e-14);
    CHECK(std::norm(modes.right(0, n)) + std::norm(modes.right(1, n)) == Approx(1));
  }
}
