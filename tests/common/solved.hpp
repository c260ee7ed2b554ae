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
      : systems(comm, d, ledger), law(systems) {}
  Solved(const Solved&) = delete;
  Solved& operator=(const Solved&) = delete;

  /// The law of the static level on which a slide ends.
  [[nodiscard]] std::vector<quantities::Uncertain> entry() const {
    std::vector<quantities::Uncertain> law_of_level;
    for (double p : law.excursion().entry) law_of_level.push_back({p, 0});
    return law_of_level;
  }
  [[nodiscard]] double mean_square_velocity() const {
    double sum = 0;
    for (double square : law.excursion().slide_square) sum += square;
    return sum / law.excursion().mean_excursion();
  }

  petsc::Ledger ledger;
  operators::Systems systems;
  quantities::StationaryLaw law;
};

}  // namespace stickslip::test
