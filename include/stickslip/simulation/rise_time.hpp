#pragma once
/// When a body gets as fast as wanted, in a piece of its motion.

#include <boost/math/tools/toms748_solve.hpp>
#include <cstdint>

#include "stickslip/support/infinity.hpp"

namespace stickslip::simulation {

/// The time at which |v| reaches `to` from `speed` below it within `time`; infinite where it does
/// not. The speed rises or falls all along a piece.
template <class Flow>
[[nodiscard]] double rise_time(const Flow& flow, double speed, double force, double time,
                               double to) {
  const auto above = [&](double t) { return flow.move(speed, force, t, false).end - to; };
  if (!(above(time) >= 0)) return kInfinity;
  std::uintmax_t most = 60;
  return boost::math::tools::toms748_solve(above, 0.0, time,
                                           boost::math::tools::eps_tolerance<double>(40), most)
      .second;
}

}  // namespace stickslip::simulation
