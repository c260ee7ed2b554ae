#include "stickslip/model/friction.hpp"

#include "stickslip/model/grid_index.hpp"

namespace stickslip::model {

bool Friction::symmetric() const {
  return mu_s_minus.value_or(mu_s) == mu_s && mu_d_minus.value_or(mu_d) == mu_d;
}

Friction Friction::mirrored() const {
  return {mu_s_minus.value_or(mu_s), mu_d_minus.value_or(mu_d), mu_s, mu_d};
}

double Friction::net_force(double level, double bias) const {
  return snapped_difference(level, mu_d - bias);
}

}  // namespace stickslip::model
