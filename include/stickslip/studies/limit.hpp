#pragma once
/// Limits of values at falling noise steps or correlation times.

#include <span>

#include "stickslip/support/uncertain.hpp"

namespace stickslip::studies {

/// A value and the delta or tau it belongs to.
struct Sample {
  double at, value, error;
};

/// q for which the last three samples fit u + C delta^q; NaN if there is none, or their changes are
/// within their errors.
[[nodiscard]] double observed_order(std::span<const Sample> samples);

/// u of u + C_1 delta^p_1 + C_2 delta^p_2 + ..., through as many of the last samples as make the
/// error smallest: the change that leaving the last sample out would make, and the errors of the
/// samples as they are weighted. The powers are 1, 2, 3, ... for mu_d < mu_s, and go by halves from
/// 3/2 or 2 on, whichever is nearer to the observed order, for mu_d = mu_s, where a layer of
/// grazing bodies is sqrt(delta) wide; so it was found of all means and probabilities. An observed
/// order more than 1/4 away from the first power stands for itself: then the last two samples are
/// extrapolated with it, and the error is the change from one such limit to the next. NaN where
/// they fit no order. O(n^4) for n samples.
[[nodiscard]] Uncertain limit_of(std::span<const Sample> samples, double order, bool grazing);

/// u of u + C_1 tau^(1/2) + C_2 tau + C_3 tau^(3/2) + ..., whichever of them are 0. The error is
/// the larger of the changes that the last sample and the last power make, and the errors of the
/// samples as they are weighted; as many powers are taken as make it smallest. None where the
/// changes of the samples grow.
[[nodiscard]] Uncertain limit_in_half_powers(std::span<const Sample> samples);

}  // namespace stickslip::studies
