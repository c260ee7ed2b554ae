#include "stickslip/operators/discretisation.hpp"

namespace stickslip::operators {

// Functions of the noise are not smooth on the levels that do not move at that speed.
Discretisation Discretisation::killing_at(double speed) const {
  const auto standing = [speed](const model::Process& half) {
    return half.friction.at_rest() - half.bias - half.drag(speed);
  };
  noise::Grouping grouping = noise->grouping();
  grouping.special = {standing(process), -standing(process.mirrored())};
  return {process, velocities->killing_at(speed),
          std::make_shared<noise::Nodes>(process, grouping)};
}

}  // namespace stickslip::operators
