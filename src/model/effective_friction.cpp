#include "stickslip/model/effective_friction.hpp"

#include <cmath>

namespace stickslip::model {

std::optional<double> effective_mu_s(const Scene& scene, bool backwards) {
  if (scene.noise.table || scene.noise.name.empty()) return std::nullopt;
  const Process forwards = scene.meant(), process = backwards ? forwards.mirrored() : forwards;
  if (process.highest_static() == process.noise.highest())
    return std::nullopt;  // never slides there
  const double given = process.friction.mu_s,
               effective = process.noise.level(process.highest_static()) + process.bias;
  constexpr double rounding = 1e-9;  // of the sum, and of what people write
  if (std::abs(effective - given) <= rounding * (given + std::abs(process.bias))) {
    return std::nullopt;
  }
  return effective;
}

}  // namespace stickslip::model
