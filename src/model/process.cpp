#include "stickslip/model/process.hpp"

#include <fmt/format.h>

namespace stickslip::model {

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
