#include "stickslip/model/friction.hpp"

#include "stickslip/model/grid_index.hpp"

namespace stickslip::model {

int Friction::static_index(double delta) const { return floor_index(mu_s / delta); }

double Friction::excess(double level) const { return snapped_difference(level, mu_d); }

}  // namespace stickslip::model
