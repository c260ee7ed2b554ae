#pragma once
/// The stationary law from one transposed solve with the sliding operator.

#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/excursion.hpp"

namespace stickslip::quantities {

/// Occupation of the sliding states over one excursion and what follows from it:
///
///   nu A(0, even) = g,   entry = -nu A_us,   stick_time (-Q) = entry,
///
/// so that pi = (nu, stick_time)/E[tau_1], symmetrised, and pi(f) is a sum for every f.
///
/// Without symmetry, on both half lines: nu+ A(0, none) = g+ and nu- A = g- for excursions from s+
/// and s-. The sides from which excursions start are a Markov chain; with its stationary shares,
///
///   p+/p- = P(s- to s+)/P(s+ to s-) = (entry- . h+)/(entry+ . h-),
///
/// h+-(i) the probability that a stay that begins on level i ends upwards or downwards, all sums
/// positive, nu = p+ nu+ + p- nu- takes the place of the nu above.
class StationaryDistribution {
 public:
  /// One transposed solve with systems.at(0, even), or two with systems.at(0, none). Collective.
  /// Throws NotReached or NoMemory.
  explicit StationaryDistribution(operators::Systems& systems);

  /// Adds Excursion::entry_orientation. It is no even functional: one more transposed solve, with
  /// systems.at(0, odd). Collective.
  void orient(operators::Systems& systems);

  [[nodiscard]] const operators::Discretisation& discretisation() const { return discretisation_; }
  [[nodiscard]] const model::Process& process() const { return discretisation_.process; }
  [[nodiscard]] const operators::StateSpace& states() const { return states_; }

  /// Means over an excursion, the same on all ranks.
  [[nodiscard]] const Excursion& excursion() const { return excursion_; }
  /// The same before the last correction of the solve: the difference shows rounding.
  [[nodiscard]] const Excursion& uncorrected() const { return uncorrected_; }

  /// Probability that an excursion from s+ ends at s-, as entry+ . h-. Without symmetry only.
  [[nodiscard]] double reversal_probability() const { return reversal_probability_; }

  /// nu, distributed as states() says [time]: the time spent in each sliding state.
  [[nodiscard]] Vec occupation() const { return occupation_; }

  /// Time spent per excursion in each state of an even or odd operator, its static states too, if
  /// it has any: rest is counted symmetry-reduced, i and -i together [time]. Collective.
  [[nodiscard]] petsc::VecHandle occupation_on(const operators::KolmogorovOperator& a) const;
  /// About the same, but positive everywhere: a weight for ReducedModel. Collective.
  [[nodiscard]] petsc::VecHandle weight_on(const operators::KolmogorovOperator& a) const;

  /// c with c f = E[V f(X, Y, V)] for odd f on an odd operator. Collective.
  [[nodiscard]] petsc::VecHandle weighted_velocity(const operators::KolmogorovOperator& a) const;

 private:
  operators::Discretisation discretisation_;
  operators::StateSpace states_;
  petsc::VecHandle occupation_;
  Excursion excursion_, uncorrected_;
  double reversal_probability_ = 0;
};

}  // namespace stickslip::quantities
