#include "stickslip/model/largest_force.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip::model {

double largest_force(const Scene& scene) {
  const auto process = scene.meant();
  const auto& noise = process.noise;
  const double highest = std::max(noise.level(noise.highest()), -noise.level(noise.lowest()));
  const auto &along = scene.friction, against = along.mirrored();
  const double seen =
      std::max(along.mu_s, against.mu_s) + noise.step() + 12 * noise.standard_deviation();
  const double drawn = std::min(highest, noise.table ? highest : seen);
  return std::max(drawn, scene.force ? std::abs(scene.force->force[scene.force->peak()]) : 0) +
         std::abs(scene.bias) - std::min(along.mu_d, against.mu_d);
}

}  // namespace stickslip::model
