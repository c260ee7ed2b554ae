#include <catch2/catch.hpp>
#include <stdexcept>

#include "stickslip/exact/dense.hpp"

using stickslip::exact::LuFactors;
using stickslip::exact::Matrix;
using stickslip::exact::row_times;
using stickslip::exact::SingularValues;

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
  CHECK(row_times(std::vector<double>{1, 2}, b) == std::vector<double>{13, 16});
  CHECK((a + a - a).largest() == 2);
}

TEST_CASE("dense: factors solve from both sides") {
  const Matrix a = sample(5, 5), b = sample(5, 3);
  const LuFactors factors(a);
  CHECK((a * factors.solve(b) - b).largest() < 1e-14);
  const std::vector<double> row{1, -2, 3, 0, 5};
  const auto product = row_times(factors.solve_row(row), a);
  for (int n = 0; n < 5; ++n) CHECK(product[n] == Approx(row[n]).margin(1e-14));
}

TEST_CASE("dense: singular matrices are refused, empty ones are fine") {
  CHECK_THROWS_AS(LuFactors(Matrix(2, 2)), std::runtime_error);
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

TEST_CASE("dense: the largest entry counts by its size") {
  Matrix m(2, 2);
  m(0, 1) = -5;
  m(1, 0) = 3;
  CHECK(m.largest() == 5);
}
