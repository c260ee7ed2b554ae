#pragma once
/// b = 0: the process as a Markov-modulated fluid queue, solved without any grid in v.

#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::exact {

/// Without drag, |V| changes at the constant rate x_i - mu_d on each noise level
/// (symmetry-reduced): a fluid queue with the noise as its phase, whose boundary v = 0 is sticky
/// for |i| <= k and sends a phase i < -k back as -i. Its law follows from the first-return matrix
///
///   Psi(i, j) = E[exp(-lambda T); phase j at the return to 0 | start at 0 in phase i],
///
/// i rising, j falling: the minimal non-negative solution of a Riccati equation, found by the
/// alternating-directional doubling algorithm (Wang, Wang and Li, SIAM J. Matrix Anal. Appl. 33,
/// 2012), quadratically convergent. Nothing of it is shared with the discretisations in v.
/// O(N^3) time, O(N^2) space.
class FluidQueue {
 public:
  /// `process` without drag; lambda >= 0 [1/time]. Throws std::invalid_argument when there is drag,
  /// std::runtime_error when the doubling does not converge.
  explicit FluidQueue(const model::Process& process, double lambda = 0);

  /// sum over k of E[exp(-lambda T); the slide from s+ ends on static level k]: F_slide(lambda).
  [[nodiscard]] double slide_transform() const;

  /// Means over one slide from s+ (lambda = 0), symmetry-reduced; index i + N.
  [[nodiscard]] const std::vector<double>& time() const { return time_; }          ///< [time]
  [[nodiscard]] const std::vector<double>& distance() const { return distance_; }  ///< int |V| dt
  [[nodiscard]] const std::vector<double>& square() const { return square_; }      ///< int V^2 dt
  /// Probability (discounted) that the slide ends on each symmetry-reduced static level, index i +
  /// k; and the same counted negative for slides that end with V < 0.
  [[nodiscard]] const std::vector<double>& entry() const { return entry_; }
  [[nodiscard]] const std::vector<double>& entry_orientation() const { return orientation_; }

  /// Largest residual of the Riccati equation against its terms.
  [[nodiscard]] double residual() const { return residual_; }

 private:
  std::vector<double> time_, distance_, square_, entry_, orientation_;
  double residual_ = 0;
};

}  // namespace stickslip::exact
