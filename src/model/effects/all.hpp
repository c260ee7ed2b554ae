#pragma once
/// All effects. The first of a list is taken unless another is named.

#include "stickslip/model/effect.hpp"

namespace stickslip::effects {

extern const Effect kCoulomb, kStribeck;
inline constexpr const Effect* kFrictions[] = {&kCoulomb, &kStribeck};

extern const Effect kOrnsteinUhlenbeck, kGaussianNoise, kTelegraph, kNarrowBand, kFilteredNoise,
    kPeriodic, kPulses, kNoiseFile, kNoiseChain, kNoiseSum;
inline constexpr const Effect* kNoises[] = {
    &kOrnsteinUhlenbeck, &kGaussianNoise, &kTelegraph, &kNarrowBand, &kFilteredNoise,
    &kPeriodic,          &kPulses,        &kNoiseFile, &kNoiseChain};

extern const Effect kLinearDrag, kNoDrag, kCubicDrag, kDragExpression;
inline constexpr const Effect* kDrags[] = {&kLinearDrag, &kNoDrag, &kCubicDrag, &kDragExpression};

// A force over time from a file, which is beside them all.

/// Its options.
[[nodiscard]] std::vector<Option> force_options();

/// Reads the record that they name, if any, into a scene; what is wrong with it is refused.
void read_force(Given& given, model::Scene& scene);

}  // namespace stickslip::effects
