#pragma once
/// The time until V first reaches a speed, from any start.

#include <vector>

#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/generator/system_key.hpp"
#include "stickslip/model/process.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/values.hpp"

namespace stickslip::quantities {

// Bodies that reach a speed before the force first changes: all at one time.

/// What such bodies add to density and distribution function at one time.
struct Unturned {
  double exact = 0;                      ///< P(T <= t) by their path, a step
  double distribution = 0, density = 0;  ///< by the elements, which smear the step out
};

/// By time > 0, from a start that is not stationary. On level i with the probability p_i such a
/// body arrives after t_i, and with the probability p_i exp(-rate_i t_i), rate_i the largest one at
/// which levels of its force are left for others, as if all were left at that rate: of those left
/// more slowly a part. On the elements it is transported by the matrix of its force alone. What has
/// less than `least` of the probability is left out. Zero on grids, which are chains of their own.
/// `killed` kills at the speed of `key`. Local. O(size^3) for each level, size that of the elements
/// below the speed.
[[nodiscard]] std::vector<Unturned>
before_first_jump(const generator::Discretisation& killed, const generator::SystemKey& key,
                  const model::Start& start, const std::vector<double>& time, double least);

/// The time before which nobody arrives from such a start, as forces between those of the lowest
/// and the highest level make nobody faster than these two; infinite beyond `longest`. 0 on grids.
/// Local.
[[nodiscard]] double earliest_arrival(const generator::Discretisation& killed,
                                      const generator::SystemKey& key, const model::Start& start,
                                      double longest);

/// u -> sliding . u + at_rest . u over the states of a start.
struct StartingPoint {
  linalg::VecHandle sliding;
  ByLevel at_rest;
};
/// On sliding states alone, those of `a`, which ends elements at `speed`. A stationary one has what
/// is beyond it; it is found on the same elements without killing, by a factorisation of its own.
/// Collective. Throws NotReached or NoMemory.
[[nodiscard]] StartingPoint starting_point(generator::Systems& systems, double speed,
                                           const model::Start& start,
                                           const generator::KolmogorovOperator& a,
                                           const StickingPhases& sticking);

/// Where excursions start, by the states that a system of that symmetry keeps.
[[nodiscard]] StickingPhases sticking_phases(const model::Process& process,
                                             generator::Symmetry symmetry, double lambda = 0);

/// 1 in the states of `a` that are not beyond the speed of a passage, 0 in others. Collective.
[[nodiscard]] linalg::VecHandle inside(const generator::KolmogorovOperator& a,
                                       const generator::SystemKey& key);

/// The systems of a passage of `speed` as asked for: with symmetry |V| has that of one branch;
/// passages of V itself need both.
[[nodiscard]] generator::SystemKey passage_system(const Planner& planner, double speed);
/// One about that passage, still without uses: a stationary start takes a factorisation of its own.
[[nodiscard]] Task passage_task(const Planner& planner, const char* name,
                                const generator::SystemKey& key);
/// From how many levels excursions start in these.
[[nodiscard]] int starts_in(const Planner& planner, const generator::SystemKey& key);

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
[[nodiscard]] PassageTime passage_time(generator::Systems& systems, const generator::SystemKey& key,
                                       const model::Start& start);

// The law of the time T until V first reaches a speed, from any start: its Laplace transform,
// density and distribution function.

/// E[exp(-lambda T)] for each lambda >= 0 [1/time], by UntilPassage with the systems lambda - L
/// killed at the speed of `key`, whose lambda does not count: sums of positive terms, with the
/// effect of iterative refinement for error. Starts beyond the speed have T = 0. A factorisation
/// for each lambda, a transposed solve for each level from which excursions start and one for the
/// start, and what starting_point() takes. NaN where rounding is all there is. Collective. Throws
/// NotReached or NoMemory.
[[nodiscard]] std::vector<Uncertain> passage_transform(generator::Systems& systems,
                                                       generator::SystemKey key,
                                                       const model::Start& start,
                                                       const std::vector<double>& lambda);

/// f(t) = c exp(-A t) r and P(T <= t) = p_0 + int_0^t f, with A the operator -L with the static
/// states that kills at the speed of `key`, r the rate of killing, c the start and p_0 what it has
/// beyond the speed; by reduced models, of all times or, where these miss the tolerance, of fewer.
/// passage_transform() at the end of the times checks A: the difference from what it gives there is
/// part of the errors. Steps of the distribution function are those of before_first_jump(), whose
/// difference from what elements make of them is part of the errors, too; the density is without
/// them. Both are 0 before earliest_arrival(). NaN where the speed is too rarely reached.
/// Collective. Throws NotReached or NoMemory.
[[nodiscard]] DurationDistribution passage_distribution(generator::Systems& systems,
                                                        const generator::SystemKey& key,
                                                        const model::Start& start,
                                                        const std::vector<double>& time,
                                                        const ModelTolerance& tolerance);

// How fast sliding phases get, and when |V| first reaches a speed.

/// Of one speed w.
struct FirstPassage {
  Uncertain exceeded;  ///< P(the largest speed of a sliding phase > w), over sliding phases as they
                       ///< follow
  Uncertain from_slide;  ///< mean time until |V| = w from the start of a sliding phase [time]
  Uncertain from_rest;   ///< the same from V = 0 with X in its stationary distribution [time]
};

/// By UntilPassage: P_peak from where sliding phases end, the means from the integral of 1. A
/// transposed solve for each start and one for the start at rest, with the systems killed at w.
/// NaN where w is reached so rarely that rounding is all there is. Collective. w > 0, below the
/// speeds that bodies tend to on the highest level of the noise. Throws NotReached or NoMemory.
[[nodiscard]] FirstPassage first_passage(generator::Systems& systems, const Starts& starts,
                                         double speed);

}  // namespace stickslip::quantities
