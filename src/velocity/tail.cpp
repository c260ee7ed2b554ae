#include "stickslip/velocity/tail.hpp"

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>

#include "log_density.hpp"

#include "stickslip/model/largest_force.hpp"
#include "stickslip/support/infinity.hpp"

namespace stickslip::velocity {
namespace {

// Of the positive branch, if it is not beyond `most`.
double upper_tail(const model::Process& process, double tolerance, double most) {
  const double drop = -std::log(tolerance) + 5;  // 5: polynomial factors of the moments
  const LogDensity log_density(process, most);
  const double slope = log_density.slope;
  const auto left = [&](double v) { return log_density(v, drop); };
  double last = 0;  // with a density that counts
  for (double v : log_density.extrema) last = left(v) > 0 ? v : last;
  const double force = slope > 0 ? slope : process.noise.standard_deviation();
  double end = std::max(drop * log_density.intensity / force, 2 * last);
  const bool open = slope <= 0 || process.drag.rises_until > 0;
  while (open && left(end) > 0 && end < process.drag.reach) end *= 2;
  end = std::min(end, process.drag.reach);
  if (process.drag.is_none() || !std::isfinite(left(end)) || left(end) > 0) return end;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      left, last, end, boost::math::tools::eps_tolerance<double>(20), iterations);
  return bracket.second;
}

// Where bodies are less fast, the forces that slow them are smaller, and of those that pulses of
// the noise overcome only these count.
double upper_tail(const model::Process& process, double tolerance) {
  constexpr int most = 20;
  double end = upper_tail(process, tolerance, kInfinity);
  for (int n = 0; n < most; ++n) {
    const double next = upper_tail(process, tolerance, end);
    if (!(next < 0.99 * end)) break;
    end = next;
  }
  return end;
}

// Of the positive branch, weighted. White noise and the weight make of the density a sum of two
// exponentials in each small range of v, of which the falling one counts.
double weighted_tail(const model::Process& process, double tolerance, double tilt) {
  constexpr double step = 0.02;
  const double drop = -std::log(tolerance) + 5, reach = process.drag.reach;
  const LogDensity log_density(process, kInfinity);
  const double d = log_density.intensity, scale = d / process.noise.standard_deviation(),
               most = std::isfinite(reach) ? reach : 1e12 * scale;
  double v = 1e-3 * scale, fallen = 0;
  while (fallen < drop && v < most) {
    const double force = log_density.slope - process.drag(v), rate = force / d;
    const double square = rate * rate - 4 * tilt * v / d;
    fallen = force > 0 && square > 0 ? fallen + step * v * std::sqrt(square) : 0;
    v *= 1 + step;
  }
  return fallen < drop ? std::max(reach, most) : v;
}

}  // namespace

double tail_velocity(const model::Process& process, double tolerance, double tilt) {
  const auto of = [&](const model::Process& branch) {
    const double tail = upper_tail(branch, tolerance);
    return tilt > 0 ? std::max(tail, weighted_tail(branch, tolerance, tilt)) : tail;
  };
  const double upper = of(process);
  return process.symmetric() ? upper : std::max(upper, of(process.mirrored()));
}

double largest_speed(const model::Scene& scene) {
  constexpr double rounding = 1e-16;
  const double force = model::largest_force(scene);
  double speed =
      std::max(scene.drag.terminal_velocity(force), scene.drag.mirrored().terminal_velocity(force));
  speed = std::min(speed, tail_velocity(scene.meant(), rounding));
  return std::min(speed, scene.v_max.value_or(speed));
}

}  // namespace stickslip::velocity
