#pragma once
/// A reduced model of the displacement that serves all weights exp(i k x(t)) and all times.

#include <complex>
#include <map>
#include <vector>

#include "stickslip/algebra/dense.hpp"
#include "stickslip/model/start.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// E[exp(i k x(t))] = c exp(t (L + i k v)) 1, c the distribution of the start, by projection on
/// real vectors: V from (R_z v)^n R_z 1 and W from c R_z (v R_z)^n with R_z = (z - L)^-1 at a few
/// real z, so that factors are real and serve all k. With the projections M of L and N of v, and b
/// and g of 1 and c, the model is g exp(t (M + i k N)) b, found by eigenvectors: a two-sided
/// projection may have growing modes, of which the shares are rounding, and which are not let grow.
/// (Talbot's contour would leave out what turns at k v.)
class DisplacementModel {
 public:
  /// For a time t > 0 and wavenumbers up to `largest`. Large ones see small displacements, for
  /// which there are vectors of z + s |v| - L as well, s up to the largest k. Collective: 6 to 15
  /// factorisations, and 200 to 350 solves. Throws NotReached or NoMemory.
  DisplacementModel(operators::Systems& systems, const StationaryDistribution& distribution,
                    const model::Start& start, double t, double largest);
  /// Compares the model at a wavenumber with true solutions, for the errors there and below.
  /// Collective: two complex factorisations. Throws NotReached or NoMemory.
  void judge(double k);

  struct Transform {
    std::complex<double> value;
    double error = 0;  ///< of the modulus: how far models of fewer vectors, or truths, are off
  };
  /// Local. O(pairs^3).
  [[nodiscard]] Transform transform(double k) const;

 private:
  /// Projections on the first vectors.
  struct Projected {
    algebra::Matrix<double> m, n;
    std::vector<double> b, g;
    [[nodiscard]] std::complex<double> transform(double k, double t, double& grown) const;
    [[nodiscard]] std::complex<double> resolvent(std::complex<double> z, double k) const;
  };
  struct Products;
  [[nodiscard]] static Projected projected(const Products& all, int size);

  operators::Systems& systems_;
  operators::KolmogorovOperator a_;
  double t_, speed_ = 0;
  std::vector<double> start_;  // c, of this rank
  Projected fine_, coarse_;
  // By wavenumber: how much further off truths are than the models from each other.
  std::map<double, double> caution_;
};

}  // namespace stickslip::quantities
