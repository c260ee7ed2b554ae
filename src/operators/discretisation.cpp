#include "stickslip/operators/discretisation.hpp"

namespace stickslip::operators {

// Functions of the noise are not smooth on the levels that do not move at that speed.
Discretisation Discretisation::killing_at(double speed) const {
  const auto standing = [speed](const model::Process& branch) {
    return branch.friction.at_rest() - branch.bias - branch.drag(speed);
  };
  noise::Grouping grouping = noise->grouping();
  grouping.special = {standing(process), -standing(process.mirrored())};
  return {process, velocities->killing_at(speed),
          std::make_shared<noise::Nodes>(process, grouping)};
}

}  // namespace stickslip::operators
