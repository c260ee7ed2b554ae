#pragma once
/// The stationary distribution as a field over (x, v), and the distribution of |V|.

#include <mpi.h>

#include <memory>
#include <vector>

#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/system_key.hpp"
#include "stickslip/generator/velocity_methods.hpp"

namespace stickslip::generator {

// A function on the whole (x, v) grid.

class StateSpace;

}  // namespace stickslip::generator

namespace stickslip::quantities {

/// Values by rows of x_i, |i| <= N, and columns of v, -v_max ... v_max without 0, kept by noise
/// nodes, of which whole groups are owned by ranks. A noise without levels has rows at evenly
/// spaced forces, see model::Shown.
class PhaseField {
 public:
  /// How values on noise nodes stand for those on levels.
  enum class Kind {
    function,  ///< u_i = sum_l P_il u_l
    measure    ///< nu_i = sum_l T_il nu_l
  };

  /// All zero.
  PhaseField(const generator::Discretisation& discretisation, const generator::StateSpace& states,
             Kind kind);

  /// Adds to the velocity node of a branch on a noise node counted along it: (x_n, v) of the
  /// positive one, (-x_n, -v) of the negative one. A noise node of this rank.
  void add(generator::Branch branch, int noise, int node, double value);

  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const std::vector<double>& v() const { return v_; }
  /// Levels of this rank, counted from the lowest of all, and their rows; without levels the first
  /// rank has all. Collective. O(levels velocity nodes).
  [[nodiscard]] std::vector<std::size_t> local_levels() const;
  [[nodiscard]] std::vector<double> local_rows() const;
  /// All rows of other places, on the first rank. Collective. O(shares velocity nodes).
  [[nodiscard]] std::vector<double> rows_at(const model::Shown& shown) const;

 private:
  // Calls visit(group) for the groups of this rank, rising.
  template <class Visit>
  void for_each_group(Visit visit) const;
  [[nodiscard]] std::size_t row_start(int noise) const;

  MPI_Comm comm_;
  const model::Shown* shown_;
  std::vector<double> probability_;  // of nodes that are no levels
  std::shared_ptr<const generator::Nodes> noise_;
  int lowest_;
  Kind kind_;
  std::vector<double> x_, v_;
  std::vector<int> local_noise_;
  std::vector<double> by_node_;
};

class StationaryDistribution;

/// pi by rows of the position of a body on a spring, all forces together.
struct PositionField {
  std::vector<double> p;         ///< evenly spaced [length]
  std::vector<double> pdf;       ///< P(P in the step around p_i, V in dv)/dv, on the first rank
  std::vector<double> atom;      ///< P(P in that step, sticking)
  std::vector<double> marginal;  ///< P(P in that step)
};

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
  PositionField position = {};  ///< empty without a spring
};

/// Collective. The state at v = 0 of a grid scheme is counted with the first node.
[[nodiscard]] DensityField density_field(const StationaryDistribution& distribution);

/// The stationary distribution of |V| as point masses, the same on all ranks.
struct SpeedDistribution {
  std::shared_ptr<const generator::VelocityDiscretisation> velocities;
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
