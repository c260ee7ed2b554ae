#include "stickslip/model/effective_friction.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip::model {

std::optional<double> effective_mu_s(const Scene& scene, bool backwards) {
  if (scene.noise.table || scene.noise.name.empty()) return std::nullopt;
  const Process forwards = scene.meant(), process = backwards ? forwards.mirrored() : forwards;
  const bool slides_there = process.highest_static() < process.noise.highest();
  if (!process.sticks() || !slides_there) return std::nullopt;
  const double given = process.friction.mu_s,
               effective = process.noise.level(process.highest_static()) + process.bias;
  constexpr double rounding = 1e-9;    // of the sum, and of what people write
  constexpr double negligible = 1e-6;  // of the distance of levels
  const double least =
      std::max(rounding * (given + std::abs(process.bias)), negligible * scene.delta);
  return std::abs(effective - given) <= least ? std::nullopt : std::optional(effective);
}

}  // namespace stickslip::model
