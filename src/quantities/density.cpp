#include "stickslip/quantities/density.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/quantities/stationary.hpp"

namespace stickslip::quantities {
namespace {

using operators::Branch;
using operators::State;
using operators::StateKind;

// Calls visit(branch, state, probability) for the local sliding states; what is symmetry-reduced
// stands for two places, each with half of the mass.
template <class Visit>
void for_each_place(const StationaryDistribution& distribution, Visit visit) {
  const double total = distribution.excursion().mean_excursion();
  const petsc::ReadView local(distribution.occupation());
  PetscInt at = 0;
  distribution.states().for_each_local([&](const State& state) {
    const double probability = PetscRealPart(local[at++]) / total;
    if (!distribution.states().symmetry_reduced()) return visit(state.branch, state, probability);
    visit(Branch::positive, state, probability / 2);
    visit(Branch::negative, state, probability / 2);
  });
}

std::vector<double> atoms(const StationaryDistribution& distribution) {
  const auto& process = distribution.process();
  const int n = -process.noise.lowest();
  const int lowest = process.lowest_static(), highest = process.highest_static();
  const auto& stick = distribution.excursion().stick_time;
  const double total = distribution.excursion().mean_excursion();
  std::vector<double> atom(static_cast<std::size_t>(process.noise.count()), 0.0);
  for (int i = lowest; i <= highest; ++i) {
    atom[n + i] = stick[i - lowest] / total;
    if (distribution.states().symmetry_reduced()) {
      atom[n + i] = (stick[i - lowest] + stick[highest - i]) / (2 * total);
    }
  }
  return atom;
}

// What belongs to v > 0, beside its mirror image.
std::vector<double> on_both_signs(std::span<const double> upper, double factor) {
  std::vector<double> all;
  std::transform(upper.rbegin(), upper.rend(), std::back_inserter(all),
                 [factor](double value) { return factor * value; });
  all.insert(all.end(), upper.begin(), upper.end());
  return all;
}

double least_value(MPI_Comm comm, const PhaseField& field) {
  double least = 0;
  for (double value : field.local_rows()) least = std::min(least, value);
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, comm);
  return least;
}

}  // namespace

DensityField density_field(const StationaryDistribution& distribution) {
  const auto& [process, noise, velocities] = distribution.discretisation();
  const auto weights = velocities->weights();
  const int nodes = velocities->size(), first = noise->first();
  std::vector<double> noise_marginal(static_cast<std::size_t>(noise->count()), 0.0);
  DensityField field{
      PhaseField(distribution.discretisation(), distribution.states(), PhaseField::Kind::measure),
      on_both_signs(weights, 1),
      on_both_signs(velocities->cells(), -1),
      0,
      atoms(distribution),
      {},
      std::vector<double>(2 * static_cast<std::size_t>(nodes), 0.0),
      {},
      speed_distribution(distribution).at_top};
  const auto& chain = process.noise;
  for (int i = chain.lowest(); i <= chain.highest() && !chain.neighbours_only(); ++i) {
    field.states.push_back(static_cast<double>(chain.table->listed(i)));
  }
  for_each_place(distribution, [&](Branch side, const State& state, double probability) {
    const bool upper = side == Branch::positive;
    noise_marginal[(upper ? state.noise : -state.noise) - first] += probability;
    if (state.kind == StateKind::holding) return;
    // The node of a state at the origin is 0.
    const double density = probability / weights[state.node];
    field.pdf.add(side, state.noise, state.node, density);
    field.velocity_marginal[upper ? nodes + state.node : nodes - 1 - state.node] += density;
  });
  for (auto* marginal : {&noise_marginal, &field.velocity_marginal}) {
    petsc::sum_over_ranks(distribution.states().comm(), *marginal);
  }
  field.cells.erase(field.cells.begin() + static_cast<std::ptrdiff_t>(field.cells.size() / 2) - 1);
  field.least = least_value(distribution.states().comm(), field.pdf);
  field.noise_marginal = noise->spread(noise_marginal);
  for (std::size_t i = 0; i < field.atom.size(); ++i) field.noise_marginal[i] += field.atom[i];
  return field;
}

SpeedDistribution speed_distribution(const StationaryDistribution& distribution) {
  const double total = distribution.excursion().mean_excursion();
  const std::size_t nodes = distribution.discretisation().velocities->size();
  std::vector<double> sums(nodes + 2, 0.0);  // of the nodes, the origin and the holding states
  const petsc::ReadView local(distribution.occupation());
  PetscInt at = 0;
  distribution.states().for_each_local([&](const State& state) {
    std::size_t place = static_cast<std::size_t>(state.node);
    if (state.kind != StateKind::node) place = nodes + (state.kind == StateKind::holding ? 1 : 0);
    sums[place] += PetscRealPart(local[at++]) / total;
  });
  petsc::sum_over_ranks(distribution.states().comm(), sums);
  return {distribution.discretisation().velocities,
          {sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(nodes)},
          sums[nodes] + distribution.excursion().mean_stick() / total,
          sums[nodes + 1]};
}

double distance(const SpeedDistribution& a, const SpeedDistribution& b) {
  double largest = std::abs(a.at_rest - b.at_rest);
  for (double v : b.velocities->cells()) {
    const double below_a = a.at_rest + a.velocities->mass_below(a.mass, v);
    const double below_b = b.at_rest + b.velocities->mass_below(b.mass, v);
    largest = std::max(largest, std::abs(below_a - below_b));
  }
  return largest;
}

void density_tasks(Planner& planner) { planner.need_distribution(); }

}  // namespace stickslip::quantities
