#pragma once
/// Discretisations with their systems and stationary laws.

#include <vector>

#include "scenes.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/stationary.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::test {

/// What the quantities of dynamics start from.
struct Solved {
  explicit Solved(const Discrete& d, MPI_Comm comm = PETSC_COMM_WORLD)
      : systems(comm, d, statistics), distribution(systems) {}
  Solved(const Solved&) = delete;
  Solved& operator=(const Solved&) = delete;

  /// The law of the static level on which a slide ends.
  [[nodiscard]] std::vector<quantities::Uncertain> entry() const {
    std::vector<quantities::Uncertain> law_of_level;
    for (double p : distribution.excursion().entry) law_of_level.push_back({p, 0});
    return law_of_level;
  }
  [[nodiscard]] double mean_square_velocity() const {
    double sum = 0;
    for (double square : distribution.excursion().slide_square) sum += square;
    return sum / distribution.excursion().mean_excursion();
  }

  petsc::SolverStatistics statistics;
  operators::Systems systems;
  quantities::StationaryDistribution distribution;
};

}  // namespace stickslip::test
