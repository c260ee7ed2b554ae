#include "stickslip/accuracy/carry_out.hpp"

#include <algorithm>

#include "stickslip/accuracy/comparison.hpp"
#include "stickslip/catalogue/given_force_keys.hpp"
#include "stickslip/quantities/excursion.hpp"
#include "stickslip/quantities/given_force.hpp"

namespace stickslip::accuracy {
namespace {

using catalogue::Quantity;

bool closed_noise_distribution(const cases::Case& given) {
  return given.question.wants(Quantity::noise_law) && given.method.row().closed_noise_law;
}

Outcome by_simulation(MPI_Comm comm, const cases::Case& given, const std::string& checkpoint,
                      const monte_carlo::SimulationProgress& progress) {
  Outcome outcome;
  auto simulated = monte_carlo::simulate(comm, given, checkpoint, progress);
  outcome.results = std::move(simulated.results);
  outcome.reached = simulated.reached;
  outcome.shortfall = simulated.shortfall;
  outcome.next_digit_seconds = 100 * simulated.state.seconds;
  outcome.simulation = std::move(simulated);
  return outcome;
}

}  // namespace

bool needs_system(const cases::Case& given) {
  const bool closed = closed_noise_distribution(given);
  return std::ranges::any_of(catalogue::entries(), [&](const catalogue::Entry* entry) {
    if (!given.question.wants(entry->quantity) || entry->without_system) return false;
    return !closed || entry->quantity != Quantity::noise_law;
  });
}

Outcome carry_out(MPI_Comm comm, const cases::Case& given, const Progress& progress,
                  const monte_carlo::SimulationProgress& simulation_progress,
                  const std::string& checkpoint) {
  const cases::Question& question = given.question;
  Outcome outcome;
  outcome.reached = true;
  if (needs_system(given)) {
    outcome = given.method.row().simulates
                  ? by_simulation(comm, given, checkpoint, simulation_progress)
                  : refine(comm, given, progress);
  }
  if (closed_noise_distribution(given)) {
    quantities::append_noise_distribution(given.scene.meant(), outcome.results);
    if (question.wants(Quantity::sensitivity)) {
      quantities::append_noise_sensitivity(given.scene.meant(), outcome.results);
    }
  }
  if (question.wants(Quantity::trajectory)) {
    outcome.path = simulation::simulate_path(given.scene.meant(), question.start, question.horizon,
                                             given.method.seed);
  }
  if (question.wants(catalogue::kGivenForce.quantity)) {
    const auto missed = quantities::append_given_force(given.scene, question.accuracy,
                                                       outcome.results, question.start.v);
    if (!missed.empty()) outcome.shortfall = missed;
    outcome.reached = outcome.reached && missed.empty();
  }
  if (!question.references.empty()) {
    outcome.comparison = compare(question.references, outcome.results);
  }
  return outcome;
}

}  // namespace stickslip::accuracy
