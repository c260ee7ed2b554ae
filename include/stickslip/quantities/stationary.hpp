#pragma once
/// The stationary distribution from one transposed solve with the sliding operator.

#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// Scales nu with nu A = the value at a start, A of lambda and even or of no symmetry, such that
/// sliding ends somewhere: sum_i P_i + lambda nu 1 = 1 holds on every discretisation. Where sliding
/// phases last long against the time steps of the noise, nu is nearly a null vector of A, and
/// rounding (of the entries of A too) changes little but its length; this sets it right. The sum
/// less 1. Throws NotReached where rounding leaves little of it. Collective.
double normalise(const operators::KolmogorovOperator& a, Vec nu, double lambda = 0);

/// Occupation of the sliding states over one excursion and what follows from it:
///
///   nu A(0, even) = g,   entry = -nu A_us,   stick_time (-Q) = entry,
///
/// so that pi = (nu, stick_time)/E[tau_1], symmetrised, and pi(f) is a sum for every f.
///
/// Without symmetry, on both velocity branches: nu_t A(0, none) = g_t for excursions from each
/// level t from which they start, s+ and s- where the noise jumps to neighbours. These levels are a
/// Markov chain with the transition probabilities entry_t . h_u, h_u(i) the probability that a
/// sticking phase that begins on level i ends by a jump to u. With its stationary shares p, found
/// without subtraction, nu = sum_t p_t nu_t takes the place of the nu above.
///
/// A body that never rests has no excursions: nu is the null vector of A, as
/// KolmogorovOperator::kill_in_one_state() says, scaled to the time 1.
class StationaryDistribution {
 public:
  /// One transposed solve with systems.at(0, even), or one a start with systems.at(0, none), all
  /// together. Collective. Throws NotReached or NoMemory.
  explicit StationaryDistribution(operators::Systems& systems);

  /// Adds Excursion::entry_plus, where it is not there. It is no even functional: one more
  /// transposed solve, with systems.at(0, odd). Collective.
  void orient(operators::Systems& systems);

  [[nodiscard]] const operators::Discretisation& discretisation() const { return discretisation_; }
  [[nodiscard]] const model::Process& process() const { return discretisation_.process; }
  [[nodiscard]] const operators::StateSpace& states() const { return states_; }

  /// Means over an excursion, the same on all ranks.
  [[nodiscard]] const Excursion& excursion() const { return excursion_; }
  /// The same before iterative refinement of the solution: the difference shows rounding.
  [[nodiscard]] const Excursion& uncorrected() const { return uncorrected_; }
  /// Appends what follows from the excursion, with rounding for error: the effect of iterative
  /// refinement, and the defect of an exact identity.
  void append_from(const FunctionOfExcursion& append, Results& results) const;
  /// Excursion::entry, with the effect of iterative refinement.
  [[nodiscard]] std::vector<Uncertain> entry() const;

  /// How excursions follow one another; with symmetry all start at s+. None where bodies never
  /// rest.
  [[nodiscard]] const Starts& starts() const { return starts_; }
  /// u -> the mean of u over the states in which excursions start, on any operator. Collective.
  [[nodiscard]] petsc::VecHandle starts_on(const operators::KolmogorovOperator& a) const;

  /// nu, distributed as states() says [time]: the time spent in each sliding state.
  [[nodiscard]] Vec occupation() const { return occupation_; }
  /// The same before iterative refinement.
  [[nodiscard]] Vec uncorrected_occupation() const { return uncorrected_occupation_; }

  /// Time spent per excursion in each state of any operator, its static states too, if it has any:
  /// symmetry-reduced, i and -i at rest are counted together [time]. Collective.
  [[nodiscard]] petsc::VecHandle occupation_on(const operators::KolmogorovOperator& a) const;
  /// About the same, but positive everywhere: a weight for ReducedModel. Collective.
  [[nodiscard]] petsc::VecHandle weight_on(const operators::KolmogorovOperator& a) const;

  /// b = v - m, m = E[V], and c with c f = E[(V - m) f(X, Y, V)], for functions of
  /// velocity_symmetry on such an operator. Collective.
  struct Velocity {
    petsc::VecHandle b, c;
  };
  [[nodiscard]] Velocity velocity(const operators::KolmogorovOperator& a) const;
  /// Odd where the process is symmetric.
  [[nodiscard]] operators::Symmetry velocity_symmetry() const {
    return process().symmetric() ? operators::Symmetry::odd : operators::Symmetry::none;
  }

 private:
  operators::Discretisation discretisation_;
  operators::StateSpace states_;
  petsc::VecHandle occupation_, uncorrected_occupation_;
  Excursion excursion_, uncorrected_;
  Starts starts_;
};

/// |x| and 1e-12 of the largest more. Collective.
[[nodiscard]] petsc::VecHandle positive_weight(petsc::VecHandle x);

}  // namespace stickslip::quantities
