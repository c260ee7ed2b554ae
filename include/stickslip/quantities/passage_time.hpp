#pragma once
/// The time until V first reaches a speed, from any start.

#include "stickslip/model/passage.hpp"
#include "stickslip/model/start.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/uncertain.hpp"

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
[[nodiscard]] PassageTime passage_time(operators::Systems& systems, const operators::SystemKey& key,
                                       const model::Start& start);

}  // namespace stickslip::quantities
