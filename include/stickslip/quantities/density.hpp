#pragma once
/// The stationary law as a field over (x, v).

#include <vector>

#include "stickslip/quantities/phase_field.hpp"
#include "stickslip/quantities/stationary.hpp"

namespace stickslip::quantities {

/// pi on the whole grid. Marginals and atoms are on all ranks.
struct DensityField {
  PhaseField pdf;                         ///< density in v at fixed x_i [1/velocity]
  std::vector<double> atom;               ///< P(X = x_i, sticking), index i + N
  std::vector<double> noise_marginal;     ///< P(X = x_i) summed over the grid, index i + N
  std::vector<double> velocity_marginal;  ///< density of V without its atom P_stick [1/velocity]
  double cut_mass = 0;                    ///< probability kept in holding states at |V| = v_max
};

/// Collective. The state at v = 0 of a grid scheme is counted with the first node.
[[nodiscard]] DensityField density_field(const StationaryLaw& law);

}  // namespace stickslip::quantities
