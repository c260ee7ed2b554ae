#include "stickslip/model/friction.hpp"

#include <cmath>

#include "stickslip/model/grid_index.hpp"

namespace stickslip::model {

double Stribeck::share(double v) const { return -std::expm1(-std::pow(v / velocity, exponent)); }

double Stribeck::share_by_velocity(double v) const {
  const double power = std::pow(v / velocity, exponent);
  return -exponent / velocity * power * std::exp(-power);
}

bool Friction::symmetric() const {
  return mu_s_minus.value_or(mu_s) == mu_s && mu_d_minus.value_or(mu_d) == mu_d;
}

bool Friction::weakens() const {
  const Friction backwards = mirrored();
  return stribeck && (mu_s > mu_d || backwards.mu_s > backwards.mu_d);
}

Friction Friction::mirrored() const {
  return {mu_s_minus.value_or(mu_s), mu_d_minus.value_or(mu_d), mu_s, mu_d, stribeck};
}

double Friction::net_force(double level, double bias) const {
  return snapped_difference(level, at_rest() - bias);
}

}  // namespace stickslip::model
