#pragma once
/// From what is asked to what is followed, and from a tally to results.

#include "stickslip/cases/case.hpp"
#include "stickslip/quantities/results.hpp"
#include "stickslip/simulation/tally.hpp"

namespace stickslip::monte_carlo {

[[nodiscard]] simulation::Wanted wanted_of(const cases::Question& question,
                                           const model::Process& process);

/// Local.
[[nodiscard]] quantities::Results estimates(const cases::Question& question,
                                            const model::Process& process,
                                            const simulation::Tally& tally);

}  // namespace stickslip::monte_carlo
