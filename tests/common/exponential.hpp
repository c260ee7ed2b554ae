#pragma once
/// exp(M t) of small dense matrices, by squaring a Taylor polynomial.

#include <cmath>

#include "stickslip/algebra/dense.hpp"

namespace stickslip::test {

using Matrix = algebra::Matrix<double>;

/// exp(M t). O(size^3 log |M t|).
inline Matrix exponential(Matrix m, double t) {
  m *= t;
  int squarings = 0;
  for (double size = m.rows() * m.largest(); size > 0.5; size /= 2) ++squarings;
  m *= std::pow(0.5, squarings);
  // Horner: 1 + M (1 + M/2 (1 + M/3 (...))).
  const Matrix one = Matrix::identity(m.rows());
  Matrix sum = one;
  for (int n = 15; n >= 1; --n) sum = 1.0 / n * (m * sum) + one;
  for (int n = 0; n < squarings; ++n) sum = sum * sum;
  return sum;
}

}  // namespace stickslip::test
