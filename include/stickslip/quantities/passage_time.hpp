#pragma once
/// The time until V first reaches a speed, from any start.

#include "stickslip/model/passage.hpp"
#include "stickslip/model/start.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/uncertain.hpp"
#include "stickslip/quantities/until_passage.hpp"

namespace stickslip::quantities {

/// u -> sliding . u + at_rest . u over the states of a start.
struct StartingPoint {
  petsc::VecHandle sliding;
  ByLevel at_rest;
};
/// On sliding states alone, those of `a`, which ends elements at `speed`. A stationary one has what
/// is beyond it; it is found on the same elements without killing, by a factorisation of its own.
/// Collective. Throws NotReached or NoMemory.
[[nodiscard]] StartingPoint starting_point(operators::Systems& systems, double speed,
                                           const model::Start& start,
                                           const operators::KolmogorovOperator& a,
                                           const StickingPhases& sticking);

/// Where excursions start, by the states that a system of that symmetry keeps.
[[nodiscard]] StickingPhases sticking_phases(const model::Process& process,
                                             operators::Symmetry symmetry, double lambda = 0);

/// 1 in the states of `a` that are not beyond the speed of a passage, 0 in others. Collective.
[[nodiscard]] petsc::VecHandle inside(const operators::KolmogorovOperator& a,
                                      const operators::SystemKey& key);

/// The systems of a passage of `speed` as asked for: with symmetry |V| has that of one branch;
/// passages of V itself need both.
[[nodiscard]] operators::SystemKey passage_system(const Planner& planner, double speed);
/// One about that passage, still without uses: a stationary start takes a factorisation of its own.
[[nodiscard]] Task passage_task(const Planner& planner, const char* name,
                                const operators::SystemKey& key);
/// From how many levels excursions start in these.
[[nodiscard]] int starts_in(const Planner& planner, const operators::SystemKey& key);

struct PassageTime {
  Uncertain mean;      ///< [time]
  Uncertain variance;  ///< [time^2]
};

/// Of the systems killed at w, `key` says at lambda = 0 by which passage. From a start,
///
///   m = nu 1 + (entry + rest) . s,   s_i = t_i + sum_u h_iu m_u,
///
/// nu A = g the occupation of the sliding phase in which it begins, `entry` where that ends, `rest`
/// the static levels of the start, t_i the mean sticking time and h_iu the probability that the
/// next sliding phase begins at u; and so for each u, the m_u by renewal without subtraction, as in
/// UntilPassage. With m on all states, m(Z_t) + t is a martingale: Var T is in the same way
/// the sum of its squared jumps, sums in which nothing cancels, and of (m(z) - m)^2 over starts z.
/// A transposed solve for each start and a forward one for m; a stationary start is found on the
/// same elements without killing. NaN where w is reached so rarely that rounding is all there is.
/// Collective. Throws NotReached or NoMemory.
[[nodiscard]] PassageTime passage_time(operators::Systems& systems, const operators::SystemKey& key,
                                       const model::Start& start);

}  // namespace stickslip::quantities
