#include "stickslip/catalogue/duration_density_keys.hpp"

#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void duration_density_tally(Tally& tally) {
  using namespace catalogue;
  const auto& time = tally.question().time;
  tally.distribution(kDensitySlide, kCdfSlide, time, &Excursion::slide);
  tally.distribution(kDensityStick, kCdfStick, time, &Excursion::stick);
  tally.distribution(kDensityExcursion, kCdfExcursion, time,
                     [](const Excursion& e) { return e.slide + e.stick; });
}

}  // namespace stickslip::simulation
