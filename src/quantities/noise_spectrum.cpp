#include <algorithm>
#include <cmath>

#include "stickslip/catalogue/noise_spectrum_keys.hpp"
#include "stickslip/model/noise_power.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {

// The chain is solved for directly, as it is meant: what is truncated of it differs between
// refinement levels. Levels beyond 40 deviations are below all rounding.
void noise_spectrum_tasks(Planner& planner) {
  const auto& scene = planner.given().scene;
  const auto target = scene.noise.target;
  auto chain = scene.meant().noise;
  const double far = 40 * chain.standard_deviation() / chain.step();
  chain.levels = static_cast<int>(std::min<double>(chain.levels, std::ceil(far)));
  planner.add({"noise spectrum", {}, [target, chain](Computation& computation) {
                 auto found = array(catalogue::kSX, computation.question().omega),
                      meant = array(catalogue::kSXTarget, computation.question().omega);
                 for (double omega : computation.question().omega) {
                   found.value.push_back(model::power_spectral_density(chain, omega));
                   if (target) meant.value.push_back(target(omega));
                 }
                 found.error.assign(found.value.size(), 0.0);
                 meant.error.assign(meant.value.size(), 0.0);
                 computation.results().push_back(std::move(found));
                 if (target) computation.results().push_back(std::move(meant));
               }});
}

}  // namespace stickslip::quantities
