#pragma once
/// The white-noise bound of the density of velocities, by which elements, their degrees and the end
/// of the velocity discretisation are chosen.

#include <algorithm>
#include <cmath>
#include <vector>

#include "stickslip/model/process.hpp"

namespace stickslip::velocity {

/// log of the stationary density of white noise of intensity D on the positive branch, exp((-slope
/// v + int b)/D) with slope = F(0+) - g, g the mean force, against its largest value. Large speeds
/// make of some noises a stronger one.
struct LogDensity {
  /// At speeds up to `end`.
  LogDensity(const model::Process& process, double end)
      : drag(process.drag), slope(process.friction.at_rest() - process.mean_force()) {
    extrema.push_back(drag.terminal_velocity(-slope));
    if (drag.rises_until > 0) extrema = drag.balances(-slope);
    end = std::min(end, drag.reach);
    // The forces that slow bodies on the way; where drag rises, any.
    if (drag.is_none()) {
      intensity = process.noise.tail_intensity(slope, slope);
    } else if (drag.rises_until == 0 && std::isfinite(end)) {
      intensity = process.noise.tail_intensity(std::max(slope, 0.0), slope - drag(end));
    } else {
      intensity = process.noise.tail_intensity();
    }
    for (double v : extrema) highest = std::max(highest, -slope * v + drag.potential(v));
  }
  /// Raised by `by`.
  [[nodiscard]] double operator()(double v, double by = 0) const {
    return by - (highest + slope * v - drag.potential(v)) / intensity;
  }

  model::Drag drag;
  double slope;
  // Rising: where drag balances a bias beyond mu_d; under forces that weaken more, minima too.
  std::vector<double> extrema;
  double highest = 0;  // at v = 0
  double intensity;
};

}  // namespace stickslip::velocity
