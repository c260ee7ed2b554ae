#pragma once
/// The stationary distribution, and what is gathered over excursions and until a speed is first
/// passed.

#include <cstddef>
#include <optional>
#include <vector>

#include "stickslip/generator/resolvents.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/linalg/dense.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {

using ByLevel = std::vector<double>;  ///< of static levels, from the lowest up

/// functional . solution, with the effect of iterative refinement as its rounding. Collective.
[[nodiscard]] Uncertain value_of(Vec functional, const linalg::Solution& solution);

/// Values of sliding states, in the order in which all operators that keep the same branches list
/// them, and of those static states that an operator has: symmetry-reduced, i and -i at rest are
/// one. Collective.
[[nodiscard]] linalg::VecHandle on_states_of(const generator::KolmogorovOperator& a, Vec sliding,
                                             const ByLevel& at_rest);

// The stationary distribution from one transposed solve with the sliding operator.

/// Scales nu with nu A = the value at a start, A of lambda and even or of no symmetry, such that
/// sliding ends somewhere: sum_i P_i + lambda nu 1 = 1 holds on every discretisation. Where sliding
/// phases last long against the time steps of the noise, nu is nearly a null vector of A, and
/// rounding (of the entries of A too) changes little but its length; this sets it right. The sum
/// less 1. Throws NotReached where rounding leaves little of it. Collective.
double normalise(const generator::KolmogorovOperator& a, Vec nu, double lambda = 0);

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
  explicit StationaryDistribution(generator::Systems& systems);

  /// Adds Excursion::entry_plus, where it is not there. It is no even functional: one more
  /// transposed solve, with systems.at(0, odd). Collective.
  void orient(generator::Systems& systems);

  [[nodiscard]] const generator::Discretisation& discretisation() const { return discretisation_; }
  [[nodiscard]] const model::Process& process() const { return discretisation_.process; }
  [[nodiscard]] const generator::StateSpace& states() const { return states_; }

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
  [[nodiscard]] linalg::VecHandle starts_on(const generator::KolmogorovOperator& a) const;

  /// nu, distributed as states() says [time]: the time spent in each sliding state.
  [[nodiscard]] Vec occupation() const { return occupation_; }
  /// The same before iterative refinement.
  [[nodiscard]] Vec uncorrected_occupation() const { return uncorrected_occupation_; }

  /// Time spent per excursion in each state of any operator [time]. Collective.
  [[nodiscard]] linalg::VecHandle occupation_on(const generator::KolmogorovOperator& a) const {
    return on_states_of(a, occupation_, excursion_.stick_time);
  }
  /// About the same, but positive everywhere: a weight for ReducedModel. Collective.
  [[nodiscard]] linalg::VecHandle weight_on(const generator::KolmogorovOperator& a) const;

  /// b = v - m, m = E[V], and c with c f = E[(V - m) f(X, Y, V)], for functions of
  /// velocity_symmetry on such an operator. Collective.
  struct Velocity {
    linalg::VecHandle b, c;
  };
  [[nodiscard]] Velocity velocity(const generator::KolmogorovOperator& a) const;
  /// Odd where the process is symmetric.
  [[nodiscard]] generator::Symmetry velocity_symmetry() const {
    return process().symmetric() ? generator::Symmetry::odd : generator::Symmetry::none;
  }

 private:
  generator::Discretisation discretisation_;
  generator::StateSpace states_;
  linalg::VecHandle occupation_, uncorrected_occupation_;
  Excursion excursion_, uncorrected_;
  Starts starts_;
};

/// |x| and 1e-12 of the largest more. Collective.
[[nodiscard]] linalg::VecHandle positive_weight(linalg::VecHandle x);

// Stationary averages of functions of the state.

/// For each observable pi(f) = E[f], pi(f|stick) and pi(f|slide), in the stationary distribution
/// and given the phase; then friction_power and slip_rate = 1/mean_excursion. What symmetry makes
/// zero is exactly 0. `a` is an operator of the distribution. No solves: O(states) each.
/// Collective.
void append_averages(const StationaryDistribution& distribution,
                     const generator::KolmogorovOperator& a,
                     const std::vector<model::Observable>& observables, Results& results);

/// Derivatives of means over an excursion, M = nu f + entry . s, for a function f of the sliding
/// states and static values s. With the adjoint h, A h = f - A_us s,
///
///   dM = nu dL (h, s) + entry . ds,
///
/// where dL is the derivative of the generator on functions with the static values s: the flow
/// changes by dB, the jumps by d(Lambda alpha). One forward solve with systems.at(0, even) for each
/// M, whatever the number of parameters; one assembly for each parameter. Elements and upwind
/// directions are kept: what that leaves out is an error of the discretisation, and falls with it.
///
/// Without symmetry the shares of excursions by the level from which they start change as well. The
/// level from which the next one starts then counts like a static value: h and s get the mean of z
/// there, where (1 - P) z = h - M for the chain P of the starts (DiscountedStarts::apart). One more
/// forward solve for each M. With a single static level mean_stick takes no solve, and has no
/// derivative but that by tau.
///
/// Nodes of noise of continuous paths move with the points at which functions are not smooth, and
/// the rates between them change, at rest as well: dL is then that of the nodes.
///
/// Appends dKEY_dPARAMETER for each KEY of append_sticking() and, with `moments`, of
/// append_moments(), which takes three more solves; effects::derivatives_of has the parameters of a
/// scene. Collective.
void append_sensitivity(generator::Systems& systems, const StationaryDistribution& distribution,
                        const std::vector<model::Derivative>& parameters, bool sticking,
                        bool moments, Results& results);

/// Where sticking phases lead; nothing of a body that never rests.
struct StickingPhases {
  /// With `reduced`, by the half of the states that symmetry leaves, where all starts are alike.
  /// With a discount lambda, `exits` are transforms and integrals discounted ones.
  StickingPhases(const model::Process& process, std::vector<int> starts, bool reduced,
                 double lambda = 0);

  [[nodiscard]] ByLevel each(double value) const;
  /// The static levels of numbers for all levels of the noise, from the lowest up.
  [[nodiscard]] ByLevel static_part(const std::vector<double>& all) const;
  /// KolmogorovOperator::square_field() at rest.
  [[nodiscard]] ByLevel square_field(const ByLevel& at_rest, const ByLevel& at_starts) const;

  const model::Process& process;
  bool symmetric;
  std::vector<int> starts;
  std::optional<generator::StaticChain> chain;
  std::vector<ByLevel> exits;  ///< by start: probabilities of leaving for it
};

/// nu with nu A = g, from each start and, last, for g = `first`: `x` after iterative refinement,
/// `correction` before it, so that what follows from both shows rounding. A transposed solve for
/// each. Collective. Throws NotReached or NoMemory.
[[nodiscard]] std::vector<linalg::Solution> occupations_from(generator::System& system,
                                                             const std::vector<int>& starts,
                                                             linalg::VecHandle first);

/// Where bodies are killed at the speed, the occupation nu of a sliding phase flows to rest at the
/// rates `entry`, by level, and over the speed with the probability P; both add up to 1. With the
/// integral a = nu f + entry . s over sliding and the sticking that follows, s by level, renewal
/// gives the mean integrals m by start:
///
///   P_t m_t + sum_u q_tu (m_t - m_u) = a_t,
///
/// q_tu = entry_t . h_u the probability that the speed was not reached and the next sliding phase
/// starts at u; solved without subtraction, right however rare the passage is.
class UntilPassage {
 public:
  /// `at_rest`: probabilities of static levels at first. `solutions` are those of
  /// occupations_from(), of which `which` is taken. All have to live as long. Collective.
  UntilPassage(const generator::KolmogorovOperator& a, const StickingPhases& sticking,
               const ByLevel& at_rest, const std::vector<linalg::Solution>& solutions,
               linalg::VecHandle linalg::Solution::*which);

  /// By start, and of the first one: probabilities of reaching the speed in a sliding phase.
  [[nodiscard]] const std::vector<double>& reached() const { return reached_; }

  /// The mean integral of f, given on sliding and static states: overall, from rest by level, and
  /// from the starts. Collective.
  struct Integral {
    double overall;
    ByLevel at_rest, at_starts;
  };
  [[nodiscard]] Integral integral(Vec f, const ByLevel& f_at_rest) const;

  /// E[exp(-lambda T)], where the occupations and the sticking phases are those of lambda: with the
  /// discounted time c_t of both phases from a start,
  ///
  ///   (P_t + lambda c_t) m_t + sum_u q_tu (m_t - m_u) = P_t.
  ///
  /// `one`: 1 in all sliding states. Collective.
  [[nodiscard]] double transform(double lambda, Vec one) const;

 private:
  [[nodiscard]] Integral renewed(Integral sum, std::vector<double> killing) const;

  const StickingPhases& sticking_;
  const ByLevel& at_rest_;
  std::vector<Vec> nu_;
  std::vector<ByLevel> entry_;
  std::vector<double> reached_;
};

// The starts of excursions as a chain whose steps are discounted.

/// From start t excursions take the discounted time w_t = E_t int_0^T exp(-lambda s) ds, and the
/// next one starts at u with h_tu = E_t[exp(-lambda T); it starts at u]; sum_u h_tu = 1 - lambda
/// w_t. All is said by visits to one of the starts, a frequent one, which the others reach without
/// subtraction; errors are those of first order that the errors of w and h allow, by the same
/// eliminations. Local. O(starts^3).
class DiscountedStarts {
 public:
  /// h by rows, `positive` where it is rounding alone that makes it less; lambda >= 0 [1/time].
  DiscountedStarts(double lambda, std::vector<Uncertain> w, std::vector<std::vector<Uncertain>> h,
                   bool positive = true);

  /// p f/p w, where p are the stationary shares of the chain that goes from t to u at the rate
  /// h_tu.
  [[nodiscard]] Uncertain mean(const std::vector<Uncertain>& f) const;
  /// mu with lambda w_t mu_t + sum_u h_tu (mu_t - mu_u) = f_t - mean(f) w_t, where p w mu = 0 takes
  /// the place of the equation of one start, so that lambda = 0 is no special case. Differences of
  /// f and of mu are taken pair by pair, with positive weights.
  [[nodiscard]] std::vector<Uncertain> apart(const std::vector<Uncertain>& f) const;

 private:
  [[nodiscard]] std::size_t size() const { return w_.size(); }
  template <class Term>
  [[nodiscard]] Uncertain sum(const Term& term, std::size_t without = -1) const;
  [[nodiscard]] Uncertain weight() const;
  [[nodiscard]] linalg::RateElimination steps(double lambda) const;
  [[nodiscard]] std::vector<Uncertain> with_base(const std::vector<double>& values, double at_base,
                                                 const std::vector<double>& errors = {}) const;
  [[nodiscard]] std::vector<Uncertain> solved(const std::vector<Uncertain>& source,
                                              double at_base) const;
  [[nodiscard]] std::vector<Uncertain> shares() const;

  double lambda_;
  std::vector<Uncertain> w_;
  std::vector<std::vector<Uncertain>> h_;
  std::size_t base_;  // the frequent one
  std::vector<std::size_t> others_;
  linalg::RateElimination until_base_;
  std::vector<Uncertain> reaching_;  // E_t[discount until the base is reached]
  std::vector<Uncertain> shares_;    // p, that of the base 1
};

}  // namespace stickslip::quantities
