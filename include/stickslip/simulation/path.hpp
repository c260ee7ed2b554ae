#pragma once
/// One simulated path.

#include <cstdint>
#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::simulation {

/// The state at time 0, just after every event, and at the end: jumps of the noise, and a body that
/// comes to rest or is turned round. Between events X and Y stay and V follows the flow.
struct Path {
  std::vector<double> time, x, y, v;  ///< y = sign of the motion, 0 at rest
};

/// The path from level `level` and velocity `v` up to `horizon` [time]. At v = 0 a body on
/// |X + g| <= mu_s rests. Local. O(horizon/Lambda) memory.
[[nodiscard]] Path simulate_path(const model::Process& process, int level, double v, double horizon,
                                 std::uint64_t seed);

}  // namespace stickslip::simulation
