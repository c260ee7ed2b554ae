#include "waves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "stickslip/model/same_force.hpp"
#include "stickslip/support/infinity.hpp"
#include "stickslip/velocity/mesh.hpp"

namespace stickslip::velocity {
namespace {

// Many levels damp waves much faster than the noise. Few do not, as bodies at the speed at which
// the drag holds them all take the same time to come to rest.
bool damps_fast_waves(const model::Process& process) {
  constexpr double jumps = 20;  // while the noise forgets itself
  const auto& noise = process.noise;
  return !noise.table && noise.rate() * noise.correlation_time() > jumps;
}

// The largest frequency whose waves elements follow.
double highest_followed(const model::Process& process) {
  return (damps_fast_waves(process) ? 40 : 4000) * process.noise.rate();
}

// The widest element for the levels of a table, each with its own rate, at the speed v: one wave an
// element. Bodies carry a phase from v = 0 or to it, for as long as their level lasts: none where
// they are beyond a speed at which the drag holds them.
double wave_width_of_table(const model::Process& process, double omega, double v) {
  constexpr int steps = 40;
  constexpr double lives = 20;  // of a level, after which nothing is left of a wave
  double slowest = kInfinity;
  for (const auto& side : {process, process.mirrored()}) {
    const auto& noise = side.noise;
    std::array<double, steps> drag{};  // in the middle of each step from 0 to v
    for (int n = 0; n < steps; ++n) drag[n] = side.drag((n + 0.5) / steps * v);
    const double at_end = side.drag(v);
    for (int i = noise.lowest(); i <= noise.highest(); ++i) {
      const double rate = model::change_rates(noise, i).most;
      if (omega <= rate) continue;
      const double force = side.net_force(i);
      double jumps = 0;
      for (int n = 0; n < steps && jumps < lives; ++n) {
        const double speed = force + drag[n];
        jumps += speed * force > 0 ? rate * v / steps / std::abs(speed) : lives;
      }
      if (jumps < lives) slowest = std::min(slowest, std::abs(force + at_end));
    }
  }
  return 2 * std::numbers::pi * slowest / std::min(omega, highest_followed(process));
}

double end_of_thinnest_waves(const model::Process& process, double gap) {
  return 20 * gap / process.noise.rate();
}

// Widest element that resolves the waves of frequency omega at v. A body that rests after the time
// s sees the phase exp(i omega s): on a level at a distance a from mu_d the wave length is
// 2 pi a/omega, and jumps of the noise damp it as exp(-Lambda v/a). Two waves an element are
// enough at the degrees in use; where Lambda v/a > 20 nothing is left of a wave, and then the next
// level, delta further from mu_d, has the shortest ones. Up to 4 Lambda the
// damping is so strong that graded elements do, and waves much faster than the noise are small
// beside the smooth part, so that they are followed up to highest_followed() only.
double wave_width(const model::Process& process, double omega, double gap, double v) {
  if (process.noise.table) return wave_width_of_table(process, omega, v);
  const double rate = process.noise.rate();
  const double slowest = v < end_of_thinnest_waves(process, gap)
                             ? gap
                             : std::max(gap + process.noise.step(), rate * v / 20);
  return 4 * std::numbers::pi * slowest / std::min(omega, highest_followed(process));
}

}  // namespace

bool has_unfollowed_waves(const model::Process& process, double omega) {
  return !damps_fast_waves(process) && omega > highest_followed(process);
}

bool has_waves(const model::Process& process, double omega) {
  const auto& noise = process.noise;
  double slowest = 4 * noise.rate();
  for (int i = noise.lowest(); noise.table && i <= noise.highest(); ++i) {
    slowest = std::min(slowest, model::change_rates(noise, i).most);
  }
  return omega > slowest;
}

// Splits elements that are too wide for the waves. Those of a level very near to mu_d end within
// the first element: only the part that has them is split for them.
std::vector<double> split_for_waves(const model::Process& process, double omega, double gap,
                                    std::vector<double> ends) {
  const double thinnest = end_of_thinnest_waves(process, gap);
  if (thinnest < ends[1]) ends.insert(ends.begin() + 1, thinnest);
  std::vector<double> split{ends.front()};
  for (std::size_t n = 1; n < ends.size(); ++n) {
    const double start = ends[n - 1], width = ends[n] - start;
    const auto pieces =
        static_cast<int>(std::ceil(width / wave_width(process, omega, gap, start) - 1e-9));
    for (int p = 1; p < pieces; ++p) split.push_back(start + width * p / pieces);
    split.push_back(ends[n]);
  }
  return split;
}

}  // namespace stickslip::velocity
