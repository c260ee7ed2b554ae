#pragma once
/// Where the process is at time 0.

namespace stickslip::model {

/// A state, or a distribution over states.
struct Start {
  enum class Kind {
    state,  ///< (x_level, v); v = 0 is rest on the static levels, and s+, s- or beyond otherwise
    rest,   ///< X in its stationary distribution, V = 0
    stationary  ///< the whole process in its stationary distribution
  };
  int level = 0;
  double v = 0;
  Kind kind = Kind::state;
};

}  // namespace stickslip::model
