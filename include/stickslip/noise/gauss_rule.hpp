#pragma once
/// Gauss quadrature for discrete measures, and interpolation at its nodes.

#include <span>
#include <vector>

namespace stickslip::noise {

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

}  // namespace stickslip::noise
