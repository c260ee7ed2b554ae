#include "stickslip/catalogue/moments_keys.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void moments_tally(Tally& tally) {
  tally.wanted().integrals = true;
  tally.over_time(catalogue::kEV2, &Excursion::square);
  tally.over_time(catalogue::kEAbsV, &Excursion::path);
  tally.over_time(catalogue::kEXV, &Excursion::product);
  if (tally.process().drifts()) return tally.over_time(catalogue::kEV, &Excursion::drift, -1);
  tally.report([](const Tally&) -> Estimates {
    return {{.row = &catalogue::kEV, .values = {{}}, .exact = true}};
  });
}

}  // namespace stickslip::simulation
