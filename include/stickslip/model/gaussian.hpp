#pragma once
/// Stationary Gaussian noise with a rational spectrum, of continuous paths.

#include <vector>

#include "stickslip/linalg/dense.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

/// A part of a covariance: amplitude exp(-decay t) (cos(frequency t) + sine sin(frequency t)) at
/// t >= 0.
struct CovarianceTerm {
  double amplitude;      ///< [force^2]
  double decay;          ///< [1/time]
  double frequency = 0;  ///< angular, [1/time]
  double sine = 0;
};

/// int Cov(X_0, X_t) exp(-i omega t) dt over all t of a sum of terms [force^2 time]; exact.
[[nodiscard]] double power_spectral_density(const std::vector<CovarianceTerm>& terms, double omega);

/// X = deviation Z_1, dZ = -A Z dt + noise with E[Z Z^T] = 1: all Gaussian noise of which the
/// covariance is a finite sum of terms. With a_i = d/dz_i and its adjoint a_i^+ in L^2 of the
/// normal density the generator is
///
///   L = -sum_ij A_ij a_j^+ a_i.
///
/// A is the continued fraction of the Laplace transform of the covariance, C(t)/C(0) = e_1^T
/// exp(-A t) e_1, by two-sided Lanczos: tridiagonal, so that A = (1/tau) for an
/// Ornstein-Uhlenbeck process and ((decay, -frequency), (frequency, decay)) for a narrow band.
/// Local.
class GaussianNoise final : public Projector {
 public:
  /// Throws UnfitTable, with the term in row(), where the terms are no covariance, or where paths
  /// are so smooth that the projection does not hold: less than 1/200 of what couples Z_1 to Z_2
  /// damps it.
  explicit GaussianNoise(std::vector<CovarianceTerm> terms);

  [[nodiscard]] const std::vector<CovarianceTerm>& terms() const { return terms_; }
  [[nodiscard]] double deviation() const { return deviation_; }
  [[nodiscard]] const linalg::Matrix<double>& matrix() const { return a_; }  ///< A
  [[nodiscard]] double power_spectral_density(double omega) const {
    return model::power_spectral_density(terms_, omega);
  }
  [[nodiscard]] double largest_density() const { return peak_; }  ///< of the spectrum

  /// Whether the nodes of an order are at most 6000.
  [[nodiscard]] bool fits(const Thresholds& thresholds, int order) const override;

 private:
  /// The generator on nodes. Along the force: continuous piecewise polynomials on elements that
  /// shrink towards `balance`, at the nodes of Gauss-Lobatto rules for the normal density.
  /// Across: Hermite polynomials up to a total degree, by their values at as many points. With the
  /// a_i replaced by matrices with a_i 1 = 0 and their adjoints by the true adjoints, rows sum to
  /// zero and the weights of the nodes are stationary, whatever the signs of the rates. Functions
  /// may jump at `start`, where a node stands on either side, tied together by a penalty: what
  /// sticks and what slides meet there. Degrees, modes and elements grow with `order` >= 2. O(nodes
  /// * nodes of an element).
  [[nodiscard]] Projection projection(const Thresholds& thresholds, int order) const override;
  void find_matrix();
  void require_spectrum();

  std::vector<CovarianceTerm> terms_;
  linalg::Matrix<double> a_;
  double deviation_ = 0;
  double peak_ = 0;  // of the power spectral density
};

}  // namespace stickslip::model
