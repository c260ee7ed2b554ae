#include "stickslip/model/process.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace stickslip::model {
namespace {

// The share of excursions below which a start does not count.
constexpr double kNegligibleShare = 1e-18;

}  // namespace

// What leaves the highest level that sticks upwards against what leaves the lowest one downwards,
// by the stationary distribution of the noise: in logarithms, which neither overflow nor vanish.
bool Process::starts_upwards() const {
  const int high = highest_static(), low = lowest_static();
  if (high >= noise.highest()) return false;
  if (low <= noise.lowest() || !sticks()) return true;
  if (!noise.neighbours_only()) return most_frequent_start(true) > high;
  double log_ratio = std::log(noise.up_rate(high) / noise.down_rate(low));
  for (int i = low + 1; i <= high; ++i) log_ratio += std::log(weight_ratio(noise, i));
  return log_ratio > std::log(kNegligibleShare);
}

std::vector<Process::Start> Process::starts() const {
  const int high = highest_static(), low = lowest_static();
  std::vector<Start> all;
  if (!sticks()) return all;
  if (noise.neighbours_only()) {
    const auto p = stationary_distribution(noise);
    const auto flow = [&](int from, double rate) { return p[from - noise.lowest()] * rate; };
    if (starts_downwards()) all.push_back({low - 1, flow(low, noise.down_rate(low))});
    if (starts_upwards()) all.push_back({high + 1, flow(high, noise.up_rate(high))});
    return all;
  }
  const auto p = stationary_distribution(noise);
  std::map<int, double> flows;
  double total = 0;
  for (int i = low; i <= high; ++i) {
    noise.for_each_jump(i, [&](int to, double rate) {
      if (low <= to && to <= high) return;
      flows[to] += p[i - noise.lowest()] * rate;
      total += p[i - noise.lowest()] * rate;
    });
  }
  for (const auto& [level, flow] : flows) {
    if (flow > kNegligibleShare * total) all.push_back({level, flow});
  }
  return all;
}

int Process::most_frequent_start(bool up) const {
  const int high = highest_static();
  const auto all = starts();
  const auto most = std::max_element(all.begin(), all.end(), [&](const Start& a, const Start& b) {
    const bool wanted_a = (a.level > high) == up, wanted_b = (b.level > high) == up;
    return wanted_a != wanted_b ? wanted_b : a.flow < b.flow;
  });
  return all.empty() ? (up ? noise.highest() : noise.lowest()) : most->level;
}

std::string please_report(const Process& process) {
  std::string drag = fmt::format("drag {} and {}", process.drag.linear, process.drag.cubic);
  if (process.drag.law) drag = "the drag of -drag_expression";
  return fmt::format(
      "; this should not happen: please report it with the model parameters mu_s = {}, mu_d = "
      "{}, tau = {}, delta = {}, noise_levels = {}, {}, bias = {}",
      process.friction.mu_s, process.friction.mu_d, process.noise.tau, process.noise.delta,
      process.noise.levels, drag, process.bias);
}

}  // namespace stickslip::model
