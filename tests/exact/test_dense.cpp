#include <catch2/catch.hpp>
#include <stdexcept>

#include "stickslip/exact/dense.hpp"

using stickslip::exact::LuFactors;
using stickslip::exact::Matrix;
using stickslip::exact::row_times;

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
