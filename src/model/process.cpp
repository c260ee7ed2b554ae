#include "stickslip/model/process.hpp"

#include <fmt/format.h>

#include <cmath>

namespace stickslip::model {

// What leaves the highest level that sticks upwards against what leaves the lowest one downwards,
// by the stationary distribution of the noise: in logarithms, which neither overflow nor vanish.
bool Process::starts_upwards() const {
  constexpr double negligible = 1e-18;
  const int high = highest_static(), low = lowest_static();
  if (high >= noise.highest()) return false;
  if (low <= noise.lowest() || !sticks()) return true;
  double log_ratio = std::log(noise.up_rate(high) / noise.down_rate(low));
  for (int i = low + 1; i <= high; ++i) log_ratio += std::log(weight_ratio(noise, i));
  return log_ratio > std::log(negligible);
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
