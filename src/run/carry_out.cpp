#include "stickslip/run/carry_out.hpp"

#include <algorithm>
#include <map>

#include "stickslip/case/force_rows.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/quantities/given_force.hpp"

namespace stickslip::run {
namespace {

using cases::Quantity;
using generator::SystemKey;

// Fitted to hp runs with delta from 1/2 to 1/256: eliminations reach a share of the speed of a
// matrix product, and take a time for each entry besides, for which memory has to be found; a solve
// reads the factors.
struct Speed {
  double share, per_entry, per_entry_solved;
  bool on_all_ranks;  // or on one after the other
};
constexpr Speed kByElements{0.8, 1e-8, 1.5e-9, false};
constexpr Speed kByMumps{0.35, 8e-9, 2.5e-9, true};
constexpr double kSecondsPerNonzero = 5e-9;  // of a residual
constexpr double kFixedSeconds = 5e-4;       // of a factorisation
constexpr double kSecondsOfModel = 0.03;     // of dense matrices, on small discretisations the most

class Predictor {
 public:
  Predictor(MPI_Comm comm, const cases::Case& given, const Resolution& resolution)
      : comm_(comm), given_(given), discretisation_(discretise(given.scene, resolution)) {
    step_.resolution = resolution;
    step_.unknowns = unknowns(given.scene, resolution);
  }

  PredictedStep follow(const quantities::Plan& plan) {
    for (const auto& key : plan.systems()) assemble(key);
    for (const auto& task : plan.tasks) step_.seconds += seconds_of(task);
    if (!step_.resolution.waves.empty()) step_.seconds += seconds_of_waves();
    return step_;
  }

 private:
  struct Predicted {
    double assembly = 0, factorization = 0, solve = 0;  // seconds of one
  };

  [[nodiscard]] Problem problem(linalg::SolverStatistics& statistics) const {
    return {comm_, given_, discretisation_, statistics};
  }

  const Predicted& assemble(const SystemKey& key) {
    const auto known = systems_.find(key);
    if (known != systems_.end()) return known->second;
    linalg::SolverStatistics statistics;
    const auto analysis = run::analyse(problem(statistics), key);
    step_.unknowns = std::max<std::int64_t>(step_.unknowns, statistics.unknowns);
    step_.nonzeros = std::max(step_.nonzeros, statistics.nonzeros);
    step_.factor_entries = std::max(step_.factor_entries, analysis.factor_entries);
    step_.megabytes = std::max(step_.megabytes, analysis.megabytes);
    step_.operations += analysis.operations;
    Predicted f = factored(analysis, static_cast<double>(statistics.nonzeros));
    f.assembly = statistics.assembly_seconds;
    f.factorization += statistics.analysis_seconds;
    // The time counts for the first task that uses it.
    step_.seconds += f.assembly + f.factorization;
    return systems_.emplace(key, f).first->second;
  }

  [[nodiscard]] Predicted factored(const linalg::Analysis& analysis, double nonzeros) {
    const Speed& speed = analysis.pc_type == linalg::kElementsPc ? kByElements : kByMumps;
    const int ranks = linalg::ranks(comm_), sharing = speed.on_all_ranks ? ranks : 1;
    Predicted f;
    f.factorization = kFixedSeconds + (analysis.operations / (speed.share * speed_) +
                                       speed.per_entry * analysis.factor_entries) /
                                          sharing;
    // Each has one step of iterative refinement, with two residuals and a bound.
    const double one = speed.per_entry_solved * analysis.factor_entries / sharing;
    step_.seconds_per_solution = std::max(step_.seconds_per_solution, one);
    f.solve = 2 * one + 3 * kSecondsPerNonzero * nonzeros / ranks;
    return f;
  }

  double seconds_of(const quantities::Task& task) {
    double seconds = 0;
    for (const auto& use : task.uses) {
      seconds += (use.forward + use.transposed) * assemble(use.system).solve;
    }
    if (task.derivatives == 0 && !task.adaptive) return seconds;
    // Operators of its own look like the sliding operator.
    const Predicted& like = assemble({0, generator::symmetry_of(discretisation_.process)});
    return seconds + (task.adaptive ? kSecondsOfModel : 0) + task.derivatives * like.assembly +
           task.usual_factorizations * (like.assembly + like.factorization) +
           task.usual_solves * like.solve;
  }

  // Each on elements of its own, as all factorisations together scale with the work.
  double seconds_of_waves() {
    Resolution alone = step_.resolution;
    alone.waves.clear();
    const Predicted& like = assemble({0, generator::symmetry_of(discretisation_.process)});
    const double more =
        relative_work(given_.scene, step_.resolution) / relative_work(given_.scene, alone) - 1;
    return more * (like.assembly + like.factorization);
  }

  MPI_Comm comm_;
  const cases::Case& given_;
  generator::Discretisation discretisation_;
  PredictedStep step_;
  std::map<SystemKey, Predicted> systems_;
  double speed_ = linalg::measured_speed();
};

bool closed_noise_distribution(const cases::Case& given) {
  return given.question.wants(Quantity::noise_law) && given.method.row().closed_noise_law;
}

Outcome by_simulation(MPI_Comm comm, const cases::Case& given, const std::string& checkpoint,
                      const SimulationProgress& progress) {
  Outcome outcome;
  auto simulated = simulate(comm, given, checkpoint, progress);
  outcome.results = std::move(simulated.results);
  outcome.reached = simulated.reached;
  outcome.shortfall = simulated.shortfall;
  outcome.next_digit_seconds = 100 * simulated.state.seconds;
  outcome.simulation = std::move(simulated);
  return outcome;
}

}  // namespace

PredictedStep predicted_step(MPI_Comm comm, const cases::Case& given, const quantities::Plan& plan,
                             const Resolution& resolution) {
  if (!plan.tasks.empty()) return Predictor(comm, given, resolution).follow(plan);
  PredictedStep step{resolution, unknowns(given.scene, resolution)};
  step.megabytes = predicted_bytes(given.scene, resolution, linalg::ranks(comm)) / 1e6;
  return step;
}

Prediction predict(MPI_Comm comm, const cases::Case& given) {
  Prediction prediction;
  if (!needs_system(given)) return prediction;
  prediction.plan = quantities::plan_of(given);
  if (given.method.row().simulates) return prediction;
  const RefinementSequence sequence(given);
  for (int n = sequence.first(); n <= 1; ++n) {
    const Resolution& resolution = sequence.refinement_level(n);
    const std::string shortfall = shortfall_of_memory(comm, given.scene, resolution);
    const bool fits = shortfall.empty();
    if (prediction.shortfall.empty()) prediction.shortfall = shortfall;
    prediction.steps.push_back(
        predicted_step(comm, given, fits ? prediction.plan : quantities::Plan{}, resolution));
    prediction.steps.back().fits = fits;
    prediction.seconds += prediction.steps.back().seconds;
  }
  return prediction;
}

bool needs_system(const cases::Case& given) {
  const bool closed = closed_noise_distribution(given);
  return std::ranges::any_of(cases::entries(), [&](const cases::Entry* entry) {
    if (!given.question.wants(entry->quantity) || entry->without_system) return false;
    return !closed || entry->quantity != Quantity::noise_law;
  });
}

Outcome carry_out(MPI_Comm comm, const cases::Case& given, const Progress& progress,
                  const SimulationProgress& simulation_progress, const std::string& checkpoint) {
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
  if (question.wants(cases::kGivenForce.quantity)) {
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

}  // namespace stickslip::run
