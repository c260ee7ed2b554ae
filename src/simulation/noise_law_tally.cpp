#include "stickslip/catalogue/noise_law_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void noise_law_tally(Tally& tally) {
  tally.wanted().noise = true;
  tally.over_time(catalogue::kPWithin, &Excursion::within);
  tally.over_time(catalogue::kEX2, &Excursion::noise_square);
}

}  // namespace stickslip::simulation
