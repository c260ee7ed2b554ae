#include "stickslip/simulation/tally.hpp"
#include "waiting_rows.hpp"

namespace stickslip::simulation {

void waiting_tally(Tally& tally) {
  tally.over_time(cases::kMeanWaiting, [](const Excursion& excursion) {
    const double duration = excursion.slide + excursion.stick;
    return duration * duration / 2;
  });
}

}  // namespace stickslip::simulation
