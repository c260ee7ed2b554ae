#pragma once
/// The stationary law as a field over (x, v).

#include <vector>

#include "stickslip/quantities/stationary.hpp"

namespace stickslip::quantities {

/// pi on the grid x_i, |i| <= N, times v in -v_max ... v_max without 0. Rows of whole levels are
/// owned by ranks; marginals and atoms are on all ranks.
struct DensityField {
  std::vector<double> x;                  ///< levels, 2N + 1
  std::vector<double> v;                  ///< velocities in rising order, 2 n_v
  std::vector<int> local_levels;          ///< i of the rows held here
  std::vector<double> local_rows;         ///< density in v at fixed x_i [1/velocity], row by row
  std::vector<double> atom;               ///< P(X = x_i, sticking), index i + N
  std::vector<double> noise_marginal;     ///< P(X = x_i) summed over the grid, index i + N
  std::vector<double> velocity_marginal;  ///< density of V without its atom P_stick [1/velocity]
  double cut_mass = 0;                    ///< probability kept in holding states at |V| = v_max
};

/// Collective. The state at v = 0 of a grid scheme is counted with the first node.
[[nodiscard]] DensityField density_field(const StationaryLaw& law);

}  // namespace stickslip::quantities
