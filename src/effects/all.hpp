#pragma once
/// All effects, each in a file of its own.

#include "stickslip/effects/effect.hpp"

namespace stickslip::effects {

extern const Effect kCoulomb, kStribeck;
extern const Effect kOrnsteinUhlenbeck, kTelegraph, kNarrowBand, kFilteredNoise, kPeriodic, kPulses,
    kNoiseFile, kNoiseChain, kNoiseSum;
extern const Effect kLinearDrag, kNoDrag, kCubicDrag, kDragExpression;

}  // namespace stickslip::effects
