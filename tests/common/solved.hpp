#pragma once
/// Discretisations with their systems and stationary distributions.

#include <vector>

#include "scenes.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/quantities/engines/excursions.hpp"

namespace stickslip::test {

/// What the quantities of dynamics start from.
struct Solved {
  explicit Solved(const Discrete& d, MPI_Comm comm = PETSC_COMM_WORLD)
      : systems(comm, d, statistics), distribution(systems) {}
  Solved(const Solved&) = delete;
  Solved& operator=(const Solved&) = delete;

  /// The distribution of the static level on which a sliding phase ends.
  [[nodiscard]] std::vector<quantities::Uncertain> entry() const {
    std::vector<quantities::Uncertain> of_levels;
    for (double p : distribution.excursion().entry) of_levels.push_back({p, 0});
    return of_levels;
  }
  [[nodiscard]] double mean_square_velocity() const {
    double sum = 0;
    for (double square : distribution.excursion().slide_square) sum += square;
    return sum / distribution.excursion().mean_excursion();
  }

  linalg::SolverStatistics statistics;
  generator::Systems systems;
  quantities::StationaryDistribution distribution;
};

}  // namespace stickslip::test
