#pragma once
/// The time until V first reaches a speed, from any start.

#include <vector>

#include "stickslip/quantities/durations.hpp"

namespace stickslip::quantities {

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
/// start; a stationary start is found by a factorisation of its own. NaN where rounding is all
/// there is. Collective. Throws NotReached or NoMemory.
[[nodiscard]] std::vector<Uncertain> passage_transform(generator::Systems& systems,
                                                       generator::SystemKey key,
                                                       const model::Start& start,
                                                       const std::vector<double>& lambda);

/// f(t) = c exp(-A t) r and P(T <= t) = p_0 + int_0^t f, with A the operator -L with the static
/// states that kills at the speed of `key`, r the rate of killing, c the start and p_0 what it has
/// beyond the speed; by reduced models, of all times or, where these miss the tolerance, of fewer.
/// passage_transform() at the end of the times checks A: the difference from what it gives there is
/// part of the errors. Bodies that arrive before the force first changes make steps in the
/// distribution function, whose difference from what elements make of them is part of the errors,
/// too; the density is without them. Both are 0 before anybody arrives. NaN where the speed is too
/// rarely reached. Collective. Throws NotReached or NoMemory.
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
