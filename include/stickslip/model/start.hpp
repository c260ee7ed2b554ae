#pragma once
/// Where the process is at time 0.

#include "stickslip/model/process.hpp"

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

/// Whether (-X, -Y, -V) has the distribution of (X, Y, V) at all times from this start, so that
/// means of odd functions, and of the displacement, are exactly 0.
[[nodiscard]] inline bool mirrors_itself(const Process& process, const Start& start) {
  return !process.drifts() && start.kind != Start::Kind::state;
}

}  // namespace stickslip::model
