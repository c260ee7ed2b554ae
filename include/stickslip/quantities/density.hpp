#pragma once
/// The stationary distribution as a field over (x, v), and the distribution of |V|.

#include <memory>
#include <vector>

#include "stickslip/quantities/phase_field.hpp"
#include "stickslip/velocity/velocity_discretisation.hpp"

namespace stickslip::quantities {

class StationaryDistribution;

/// pi on the whole grid. All but `pdf` is the same on all ranks. Between two neighbours among
/// `cells` the density is the polynomial through its values on the nodes there, whose integral is
/// their sum with `weights`.
struct DensityField {
  PhaseField pdf;                         ///< density in v at fixed x_i [1/velocity]
  std::vector<double> weights;            ///< of the nodes in v [velocity]
  std::vector<double> cells;              ///< -v_max ... 0 ... v_max [velocity]
  double least = 0;                       ///< smallest value: below 0 by discretisation errors
  std::vector<double> atom;               ///< P(X = x_i, sticking), index i + N
  std::vector<double> noise_marginal;     ///< P(X = x_i) summed over the grid, index i + N
  std::vector<double> velocity_marginal;  ///< density of V without its atom P_stick [1/velocity]
  std::vector<double> states;  ///< where several may have one x: numbers of the states, index i + N
  double truncated_mass = 0;   ///< probability kept in holding states at |V| = v_max
};

/// Collective. The state at v = 0 of a grid scheme is counted with the first node.
[[nodiscard]] DensityField density_field(const StationaryDistribution& distribution);

/// The stationary distribution of |V| as point masses, the same on all ranks.
struct SpeedDistribution {
  std::shared_ptr<const velocity::VelocityDiscretisation> velocities;
  std::vector<double> mass;  ///< of the velocity nodes
  double at_rest = 0;        ///< P_stick, and the origin states of a grid scheme
  double at_top = 0;         ///< holding states: the mass beyond the truncation velocity
};

/// Collective.
[[nodiscard]] SpeedDistribution speed_distribution(const StationaryDistribution& distribution);

/// sup |F_1 - F_2| over the cells of the velocity discretisation of `b`, F the distribution
/// functions.
[[nodiscard]] double distance(const SpeedDistribution& a, const SpeedDistribution& b);

}  // namespace stickslip::quantities
