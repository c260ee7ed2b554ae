#include "stickslip/catalogue/duration_density_keys.hpp"
#include "stickslip/catalogue/phase_durations_keys.hpp"

#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {
namespace {

void follow_phases(Tally& tally) {
  const auto& time = tally.question().time;
  tally.distribution(catalogue::kDensitySlide, catalogue::kCdfSlide, time, &Excursion::slide);
  tally.distribution(catalogue::kDensityStick, catalogue::kCdfStick, time, &Excursion::stick);
}

}  // namespace

void duration_density_tally(Tally& tally) {
  follow_phases(tally);
  tally.distribution(catalogue::kDensityExcursion, catalogue::kCdfExcursion, tally.question().time,
                     [](const Excursion& e) { return e.slide + e.stick; });
}

void phase_durations_tally(Tally& tally) {
  if (!tally.question().wants(catalogue::Quantity::duration_density)) follow_phases(tally);
}

}  // namespace stickslip::simulation
