#include "stickslip/operators/discretisation.hpp"

namespace stickslip::operators {

// Functions of the noise are not smooth on the levels that do not move at that speed.
std::shared_ptr<const noise::Nodes> Discretisation::nodes_for(double speed) const {
  const auto standing = [speed](const model::Process& branch) {
    return branch.friction.at_rest() - branch.bias - branch.drag(speed);
  };
  noise::Grouping grouping = noise->grouping();
  grouping.special = {standing(process), -standing(process.mirrored())};
  return std::make_shared<noise::Nodes>(process, grouping);
}

Discretisation Discretisation::killing_at(double speed) const {
  return {process, velocities->killing_at(speed), nodes_for(speed)};
}

Discretisation Discretisation::passing(double speed, std::optional<model::Passage> killed) const {
  const auto kills = [killed](model::Passage side) {
    return killed == side || killed == model::Passage::both;
  };
  const bool up = kills(model::Passage::up), down = kills(model::Passage::down);
  return {process, velocities->passing(speed, up, down), nodes_for(speed)};
}

}  // namespace stickslip::operators
