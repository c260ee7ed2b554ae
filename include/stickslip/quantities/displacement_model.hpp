#pragma once
/// The characteristic function of the displacement after a time.

#include <complex>
#include <vector>

#include "stickslip/model/start.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// phi(k) = E[exp(i k x(t))] = c exp(t (L + i k v)) 1, c the distribution of the start.
///
/// By projection on the Krylov space of (z - L - i k v)^-1 from 1, z real: one complex
/// factorisation a wavenumber, and 10 to 60 solves. Vectors are orthonormal in the stationary
/// distribution, in which L + i k v lets no function grow, so that no projection has growing modes.
class DisplacementModel {
 public:
  struct Transform {
    std::complex<double> value;
    double error = 0;  ///< of the modulus
  };

  /// `accuracy` of phi, absolute. Local.
  DisplacementModel(operators::Systems& systems, const StationaryDistribution& distribution,
                    const model::Start& start, double t, double accuracy);

  /// The error is what the last vectors change, and what another z does at the largest k so far.
  /// Collective. Throws NotReached or NoMemory.
  Transform at(double k);

  [[nodiscard]] double speed() const { return speed_; }  ///< E[V^2]^(1/2)

 private:
  [[nodiscard]] Transform projected(double k, double z);

  operators::Systems& systems_;
  operators::KolmogorovOperator a_;
  double t_, accuracy_, speed_ = 0;
  std::vector<double> root_;  // of the weight of the inner product, on this rank
  std::vector<std::complex<double>> one_, c_;
  double other_pole_ = 0, checked_ = 0;
};

/// Has solutions for exp(i k x(t)) resolved for all times of the question, up to |k| =
/// `wavenumber`.
void resolve_displacements(Planner& planner, double wavenumber);

}  // namespace stickslip::quantities
