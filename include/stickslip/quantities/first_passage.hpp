#pragma once
/// How fast sliding phases get, and when |V| first reaches a speed.

#include <vector>

#include "stickslip/operators/systems.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/uncertain.hpp"

namespace stickslip::quantities {

/// Of one speed w.
struct FirstPassage {
  Uncertain exceeded;  ///< P(the largest speed of a sliding phase > w), over sliding phases as they
                       ///< follow
  Uncertain from_slide;  ///< mean time until |V| = w from the start of a sliding phase [time]
  Uncertain from_rest;   ///< the same from V = 0 with X in its stationary distribution [time]
};

/// Where bodies are killed at |v| = w, the occupation nu A = g of a sliding phase from a start
/// flows to rest at the rates `entry` and over w at P = P(peak > w); both add up to 1. With the
/// mean time a = nu 1 + entry . t until that or the end of the excursion, t the mean sticking time
/// by level, renewal gives the mean times m by start:
///
///   P_s m_s + sum_u q_su (m_s - m_u) = a_s,
///
/// q_su = entry_s . h_u the probability that w was not reached and the next sliding phase starts at
/// u; solved without subtraction, right however rare w is. A transposed solve for each start and
/// one for the start at rest, with the systems killed at w. Collective. w > 0, below the speeds
/// that bodies tend to on the highest level of the noise. Throws NotReached or NoMemory.
[[nodiscard]] FirstPassage first_passage(operators::Systems& systems, const Starts& starts,
                                         double speed);

}  // namespace stickslip::quantities
