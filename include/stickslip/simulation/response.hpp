#pragma once
/// The motion of a body under a given force.

#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::simulation {

/// A sliding phase between two sticking phases, or up to the end of the record. A body that is
/// turned round without sticking goes on with the same one.
struct Slip {
  double begin = 0, end = 0;  ///< [time]
  double displacement = 0;    ///< int v dt over it [velocity*time]
  double peak = 0;            ///< largest |v| [velocity]
};

/// What a force does to a body.
struct Response {
  std::vector<double> v = {}, x = {};  ///< velocity and displacement at the samples
  std::vector<Slip> slips = {};
  double sliding = 0;                ///< time [time]
  double farthest = 0, fastest = 0;  ///< largest |x| and |v|
};

/// The motion under a record in the place of the noise, from a velocity at its first sample.
/// Friction, drag, bias and spring are those of the process, the spring without force at x = 0; a
/// record with a load goes with Coulomb friction alone. Where drag is linear, velocities follow
/// closed forms from one event to the next: static friction that is overcome, a body that stops or
/// turns round. Otherwise they follow Taylor series of order 14, in steps of at most `stride` of
/// the length at which these are right to rounding. Local. O(samples), the series 2 microseconds a
/// step.
[[nodiscard]] Response respond(const model::Process& process, const model::ForceRecord& record,
                               double velocity = 0, double stride = 1);

}  // namespace stickslip::simulation
