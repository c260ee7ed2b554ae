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
  double end = std::max(slope > 0 ? drop * log_density.intensity / slope : 1.0, 2 * last);
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

}  // namespace

double tail_velocity(const model::Process& process, double tolerance) {
  const double upper = upper_tail(process, tolerance);
  return process.symmetric() ? upper : std::max(upper, upper_tail(process.mirrored(), tolerance));
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
