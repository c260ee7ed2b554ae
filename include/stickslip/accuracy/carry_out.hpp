#pragma once
/// All that a case asks for: by refined discretisations, by simulation, or from the model
/// parameters alone.

#include <string>

#include "stickslip/accuracy/refinement.hpp"

namespace stickslip::accuracy {

/// Whether anything asked for takes a discretisation or a simulation; closed forms and paths do
/// not.
[[nodiscard]] bool needs_system(const cases::Case& given);

/// Everything asked for, compared with references where there are any. A checkpoint is of a
/// simulation. Collective. Throws what refine() and monte_carlo::simulate() do.
[[nodiscard]] Outcome carry_out(MPI_Comm comm, const cases::Case& given, const Progress& progress,
                                const monte_carlo::SimulationProgress& simulation_progress = {},
                                const std::string& checkpoint = {});

}  // namespace stickslip::accuracy
