#include "stickslip/catalogue/noise_spectrum_keys.hpp"
#include "stickslip/model/noise_power.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {

// The chain is solved for directly: what is truncated of it differs between refinement levels.
void noise_spectrum_tasks(Planner& planner) {
  const auto& scene = planner.given().scene;
  const auto target = scene.noise.target;
  planner.add({"noise spectrum", {}, [target](Computation& computation) {
                 const auto& chain = computation.process().noise;
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
