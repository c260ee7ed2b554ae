#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/plan.hpp"
#include "waiting_rows.hpp"

namespace stickslip::quantities {

void waiting_tasks(Planner& planner) {
  planner.need_distribution();
  planner.add({"waiting times", {{planner.system(), 4, 0}}, [](Computation& computation) {
                 const auto& distribution = computation.distribution();
                 const auto durations =
                     duration_moments(computation.systems, distribution, distribution.entry());
                 const Uncertain mean = durations.mean_excursion,
                                 square = durations.var_excursion + mean * mean;
                 computation.results().push_back(scalar(cases::kMeanWaiting, 0.5 * square / mean));
               }});
}

}  // namespace stickslip::quantities
