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

/// Where bodies are killed at |v| = w, the occupation nu A = g of a sliding phase from s+ flows to
/// rest at the rates `entry` and over w at P(peak > w); both add up to 1. With the mean time a = nu
/// 1 + entry . t until that or the end of the excursion, t the mean sticking time by level, renewal
/// gives m = a/P(peak > w) with symmetry, else
///
///   m+ = (a+ (q-+ + P-) + q+- a-)/(q+- P- + P+ q-+ + P+ P-),
///
/// q+- = entry+ . h- the probability that the next sliding phase starts at s- and w was not
/// reached: sums of positive terms, right however rare w is. A transposed solve for each side and
/// one for the start at rest, with the systems killed at w. Collective. w > 0, below the speeds
/// that bodies tend to on the highest level of the noise. Throws NotReached or NoMemory.
[[nodiscard]] FirstPassage first_passage(operators::Systems& systems, const SideChain& sides,
                                         double speed);

}  // namespace stickslip::quantities
