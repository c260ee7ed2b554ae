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

/// By UntilPassage: P_peak from where sliding phases end, the means from the integral of 1. A
/// transposed solve for each start and one for the start at rest, with the systems killed at w.
/// NaN where w is reached so rarely that rounding is all there is. Collective. w > 0, below the
/// speeds that bodies tend to on the highest level of the noise. Throws NotReached or NoMemory.
[[nodiscard]] FirstPassage first_passage(operators::Systems& systems, const Starts& starts,
                                         double speed);

}  // namespace stickslip::quantities
