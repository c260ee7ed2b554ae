#pragma once
/// The power spectral density of the noise.

#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

/// S_X(omega) = int Cov(X_0, X_t) exp(-i omega t) dt over all t [force^2 time] of a stationary
/// chain: 2 Re sum_n p_n f_n phi_n with (i omega - Q) phi = f, f = x - E[X]. O(levels band^2),
/// jumps leading over at most `band` levels.
[[nodiscard]] double power_spectral_density(const NoiseChain& chain, double omega);

}  // namespace stickslip::model
