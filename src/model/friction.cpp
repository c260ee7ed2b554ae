#include "stickslip/model/friction.hpp"

#include "stickslip/model/grid_index.hpp"

namespace stickslip::model {

int Friction::static_index(double delta, double bias) const {
  return floor_index((mu_s - bias) / delta);
}

double Friction::net_force(double level, double bias) const {
  return snapped_difference(level, mu_d - bias);
}

}  // namespace stickslip::model
