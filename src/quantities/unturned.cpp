#include "stickslip/quantities/unturned.hpp"

#include <algorithm>
#include <cmath>

#include "stickslip/algebra/dense.hpp"
#include "stickslip/model/same_force.hpp"
#include "stickslip/simulation/flow.hpp"
#include "stickslip/simulation/rise_time.hpp"

namespace stickslip::quantities {
namespace {

// When a body on one level reaches the speed, up to the time `longest`; infinite if it does not.
double arrival(const model::Process& process, const operators::SystemKey& key, int level, double v,
               double longest) {
  const double w = key.speed_limit;
  const auto mirrored = process.mirrored();
  const bool rests = process.sticks(level);
  bool upwards = v != 0 ? v > 0 : level > process.highest_static();
  double speed = std::abs(v), now = 0;
  for (bool turned = false; speed > 0 || !rests; turned = true, upwards = !upwards, speed = 0) {
    const auto& seen = upwards ? process : mirrored;
    const double force = seen.net_force(upwards ? level : -level);
    const simulation::GeneralFlow flow(seen.drag);
    if (model::has_passed(*key.passage, upwards ? w : -w, w)) {
      // Soon, as a rule: long motions take long to follow.
      for (double until = 1 / process.noise.rate(level);; until *= 4) {
        const double rise = simulation::rise_time(flow, speed, force, std::min(until, longest), w);
        if (std::isfinite(rise)) return now + rise;
        if (until >= longest) break;
      }
    }
    const auto piece = flow.move(speed, force, longest, false);
    if (turned || !piece.stopped) break;
    now += piece.time;
  }
  return kInfinity;
}

/// Transport by one force on elements, without a way back once it has changed, at a rate: u' = M u,
/// where the last state is that of having passed, and u -> start u.
struct Transport {
  algebra::Matrix<double> m;
  std::vector<double> start;
};

// Without elements beyond the speed, which nobody reaches who starts below, and without the other
// branch, unless the body may turn round.
Transport transport(const operators::Discretisation& killed, int level, double v, double w,
                    double rate) {
  const auto& process = killed.process;
  const auto& axis = *killed.velocities;
  const auto nodes = axis.nodes();
  const int size = static_cast<int>(
      std::abs(v) < w ? std::ranges::lower_bound(nodes, w) - nodes.begin() : axis.size());
  const bool rests = process.sticks(level);
  const bool pushed_up = level > process.highest_static(), starts_up = v != 0 ? v > 0 : pushed_up;
  const int branches = v == 0 || rests || starts_up == pushed_up ? 1 : 2, last = branches * size;
  Transport t{algebra::Matrix<double>(last + 1, last + 1),
              std::vector<double>(static_cast<std::size_t>(last) + 1)};
  // The branch on which the body starts is first; at v = 0 the level pushes it onto the last.
  const auto at_zero = [&](const auto& add) {
    if (rests) return;
    for (const auto& e : axis.trace_at_zero()) add(last - size + e.node, e.value);
  };
  for (int branch = 0; branch < branches; ++branch) {
    const bool up = starts_up != (branch > 0);
    const auto& along = up ? axis : axis.mirrored();
    const double force = up ? process.net_force(level) : process.mirrored().net_force(-level);
    for (int j = 0; j < size; ++j) {
      velocity::TransportRow row;
      along.transport(force, j, row);
      const int at = branch * size + j;
      double leaving = rate + row.inflow + row.outflow + row.killed;
      for (const auto& e : row.entries) {
        if (e.node < size) t.m(at, branch * size + e.node) += e.value;
        leaving += e.value;
      }
      t.m(at, at) -= leaving;
      t.m(at, last) = row.killed;
      at_zero([&](int to, double share) { t.m(at, to) += row.inflow * share; });
    }
  }
  if (v == 0) {
    at_zero([&](int to, double share) { t.start[to] += share; });
  } else {
    for (const auto& e : axis.value_at(std::abs(v))) t.start[e.node] = e.value;
  }
  return t;
}

}  // namespace

double earliest_arrival(const operators::Discretisation& killed, const operators::SystemKey& key,
                        const model::Start& start, double longest) {
  if (killed.velocities->keeps_origin()) return 0;
  const auto& process = killed.process;
  const double v = start.kind == model::Start::Kind::state ? start.v : 0;
  return std::min(arrival(process, key, process.noise.lowest(), v, longest),
                  arrival(process, key, process.noise.highest(), v, longest));
}

std::vector<Unturned> before_first_jump(const operators::Discretisation& killed,
                                        const operators::SystemKey& key, const model::Start& start,
                                        const std::vector<double>& time, double least) {
  const auto& process = killed.process;
  const bool state = start.kind == model::Start::Kind::state;
  const auto levels = model::stationary_distribution(process.noise);
  const double longest = 10 * *std::ranges::max_element(time);
  std::vector<Unturned> all(time.size());
  if (killed.velocities->keeps_origin()) return all;
  for (int i = process.noise.lowest(); i <= process.noise.highest(); ++i) {
    const double p = state ? (i == start.level ? 1 : 0)
                           : levels[static_cast<std::size_t>(i - process.noise.lowest())],
                 v = state ? start.v : 0;
    if (p < least) continue;
    constexpr double most = 40;  // jumps that do not happen
    const double rate = model::change_rates(process.noise, i).most,
                 arrives = arrival(process, key, i, v, std::min(longest, most / rate)),
                 jump = p * std::exp(-rate * arrives);
    if (jump < least) continue;
    const Transport moved = transport(killed, i, v, key.speed_limit, rate);
    for (std::size_t n = 0; n < time.size(); ++n) {
      const auto states = moved.start * algebra::exponential(moved.m, time[n]);
      all[n].exact += time[n] >= arrives ? jump : 0;
      all[n].distribution += p * states.back();
      all[n].density += p * (states * moved.m).back();
    }
  }
  return all;
}

}  // namespace stickslip::quantities
