#pragma once
/// The piecewise deterministic process (X, Y, V) with everything that fixes its law.

#include "stickslip/model/drag.hpp"
#include "stickslip/model/friction.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

/// dV/dt = X + b(V) - mu_d Y while Y = sign V is +-1; V = 0 and |X| <= mu_s is the static phase.
struct Process {
  NoiseChain noise;
  Friction friction;
  Drag drag;

  /// k: levels |i| <= k can stick.
  [[nodiscard]] int static_index() const { return friction.static_index(noise.delta); }
  /// x_i - mu_d: the speed of V at v = 0+ on level i.
  [[nodiscard]] double excess(int i) const { return friction.excess(noise.level(i)); }
};

}  // namespace stickslip::model
