#include "stickslip/catalogue/slip_keys.hpp"

#include <cmath>

#include "stickslip/simulation/tally.hpp"

namespace stickslip::simulation {

void slip_tally(Tally& tally) {
  using namespace catalogue;
  const auto& [distance, s] =
      std::tie(tally.question().distance, tally.question().inverse_distance);
  tally.wanted().integrals = true;
  tally.moments(kMeanSlip, kVarSlip, &Excursion::path);
  tally.moments(kMeanSlipNet, kVarSlipNet, &Excursion::drift, -1);
  if (!distance.empty()) {
    tally.distribution(kDensitySlip, kCdfSlip, distance, &Excursion::path);
  }
  if (s.empty()) return;
  tally.mean(kTransformSlip, s,
             [](const Excursion& e, double by) { return std::exp(-by * e.path); });
}

}  // namespace stickslip::simulation
