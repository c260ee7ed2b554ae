#pragma once
/// The characteristic function of the displacement after a time.

#include <cmath>
#include <complex>
#include <vector>

#include "stickslip/model/process.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {

/// The weight exp(s x) of paths, and a rate at which E[exp(s x(t))] grows, about.
struct Tilt {
  double s = 0;       ///< [1/(velocity time)]
  double growth = 0;  ///< [1/time]
};

/// phi(k) = E[exp(i k x(t))] = c exp(t (L + i k v)) 1, c the distribution of the start. With a tilt
/// exp(-growth t) E[exp((s + i k) x(t))].
///
/// By projection on the Krylov space of (z - L - i k v)^-1 from 1, z real: one complex
/// factorisation a wavenumber, and 10 to 60 solves. Vectors are orthonormal in the stationary
/// distribution, in which L + i k v lets no function grow, so that no projection has growing modes.
/// From another start they are so in the distribution after an exponential time of mean t/2, where
/// speeds count as far as they are reached, and functions grow by e at most in the time t.
/// With a tilt sum l u^2/r takes the place of its norm, l = c exp((L + s v) t/2) and r =
/// exp((L + s v) t/2) 1: the density of weighted paths halfway is l r, and is kept by
/// L + s v on functions u/r where t is long. Some implicit steps give both.
class DisplacementModel {
 public:
  struct Transform {
    std::complex<double> value;
    double error = 0;  ///< of the modulus
  };

  /// `accuracy` of phi, relative to phi(0). Collective, but local for a stationary start without
  /// tilt; from another one a real factorisation and solve, with a tilt as many solves as for two
  /// to four wavenumbers.
  DisplacementModel(generator::Systems& systems, const StationaryDistribution& distribution,
                    const model::Start& start, double t, double accuracy, Tilt tilt = {});

  /// The error is what the last vectors change, and what another z does at the largest k so far.
  /// Collective. Throws NotReached or NoMemory.
  Transform at(double k);

  /// Whether the discretisation resolves the tilt.
  [[nodiscard]] bool resolved() const { return resolved_; }
  [[nodiscard]] double speed() const { return std::hypot(speed_, drift_); }  ///< E[V^2]^(1/2)

 private:
  // By l and r; c is the distribution of the start.
  void weigh_by(const std::vector<double>& l, const std::vector<double>& r,
                const std::vector<double>& c);
  void weigh_tilted(const std::vector<double>& c);
  [[nodiscard]] std::vector<double> after_exponential_time(const std::vector<double>& c);
  [[nodiscard]] Transform projected(double k, double z);

  generator::Systems& systems_;
  generator::KolmogorovOperator a_;
  double t_, accuracy_, speed_ = 0;
  bool resolved_ = false;
  double drift_ = 0;  // a velocity that all have in common
  Tilt tilt_;
  double pole_;               // beyond the growth
  int vectors_ = 0;           // of the space at the last wavenumber
  std::vector<double> root_;  // of the weight of the inner product, on this rank
  std::vector<std::complex<double>> one_, c_;
  double other_pole_ = 0, checked_ = -1;
};

/// Has solutions for exp(i k x(t)) resolved for all times of the question, up to |k| =
/// `wavenumber`.
void resolve_displacements(Planner& planner, double wavenumber);

}  // namespace stickslip::quantities
