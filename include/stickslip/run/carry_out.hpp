#pragma once
/// All that a case asks for: by refined discretisations, by simulation, or from the model
/// parameters alone.

#include <mpi.h>

#include <string>
#include <vector>

#include "stickslip/case/case.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/run/discretise.hpp"
#include "stickslip/run/refine.hpp"

namespace stickslip::run {

/// Whether anything asked for takes a discretisation or a simulation; closed forms and paths do
/// not.
[[nodiscard]] bool needs_system(const cases::Case& given);

/// Everything asked for, compared with references where there are any. A checkpoint is of a
/// simulation. Collective. Throws what refine() and simulate() do.
[[nodiscard]] Outcome carry_out(MPI_Comm comm, const cases::Case& given, const Progress& progress,
                                const SimulationProgress& simulation_progress = {},
                                const std::string& checkpoint = {});

// What a run would cost, without running it.

/// One refinement step, predicted.
struct PredictedStep {
  Resolution resolution;
  std::int64_t unknowns = 0;  ///< of the largest system
  std::int64_t nonzeros = 0;
  double factor_entries = 0;  ///< of the largest factorisation, by the solver's analysis
  double megabytes = 0;       ///< of the same
  double operations = 0;      ///< of all factorisations, by the same analysis
  double seconds = 0;
  double seconds_per_solution = 0;  ///< of one solution through the factors
  bool fits = true;                 ///< into memory; if not, sizes only, and megabytes of all
};

struct Prediction {
  quantities::Plan plan;             ///< of each step
  std::vector<PredictedStep> steps;  ///< the least number that can meet the accuracy
  double seconds = 0;                ///< of all of them and of what is not refined
  std::string shortfall = {};        ///< of memory, on the first that does not fit
};

/// Assembles each system of the first steps and has the solver analyse it; nothing is factored or
/// solved. Times follow from the operations and entries counted by that analysis, with the speed of
/// a matrix product measured now, and were found within a factor 2 of real ones; a run may need
/// one or two steps more than predicted. Solution methods other than excursion: the sizes only,
/// with seconds 0. Collective.
[[nodiscard]] Prediction predict(MPI_Comm comm, const cases::Case& given);

/// The same for one step of a deterministic solution method at a given resolution. Collective.
[[nodiscard]] PredictedStep predicted_step(MPI_Comm comm, const cases::Case& given,
                                           const quantities::Plan& plan,
                                           const Resolution& resolution);

}  // namespace stickslip::run
