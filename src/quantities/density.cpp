#include "stickslip/quantities/density.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <span>

#include "stickslip/generator/state_space.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/quantities/plan.hpp"

namespace stickslip::quantities {
namespace {

using generator::Branch;
using generator::State;
using generator::StateKind;

// Calls visit(branch, state, probability) for the local sliding states; what is symmetry-reduced
// stands for two places, each with half of the mass.
template <class Visit>
void for_each_place(const StationaryDistribution& distribution, Visit visit) {
  const double total = distribution.excursion().mean_excursion();
  const linalg::ReadView local(distribution.occupation());
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

PhaseField::PhaseField(const generator::Discretisation& discretisation,
                       const generator::StateSpace& states, Kind kind)
    : comm_(states.comm()),
      shown_(discretisation.process.noise.shown()),
      noise_(discretisation.noise),
      lowest_(discretisation.process.noise.lowest()),
      kind_(kind),
      local_noise_(states.local_noise()) {
  const auto& chain = discretisation.process.noise;
  if (shown_ != nullptr) {
    x_ = shown_->x;
    probability_ = model::stationary_distribution(chain);
  } else {
    for (int i = chain.lowest(); i <= chain.highest(); ++i) x_.push_back(chain.level(i));
  }
  const auto nodes = discretisation.velocities->nodes();
  std::transform(nodes.rbegin(), nodes.rend(), std::back_inserter(v_),
                 [](double node) { return -node; });
  v_.insert(v_.end(), nodes.begin(), nodes.end());
  by_node_.assign(local_noise_.size() * v_.size(), 0.0);
}

std::size_t PhaseField::row_start(int noise) const {
  const auto place = std::lower_bound(local_noise_.begin(), local_noise_.end(), noise);
  return static_cast<std::size_t>(place - local_noise_.begin()) * v_.size();
}

void PhaseField::add(generator::Branch branch, int noise, int node, double value) {
  const std::size_t nodes = v_.size() / 2;
  const bool upper = branch == generator::Branch::positive;
  by_node_[upper ? row_start(noise) + nodes + node : row_start(-noise) + nodes - 1 - node] += value;
}

template <class Visit>
void PhaseField::for_each_group(Visit visit) const {
  for (auto n = local_noise_.begin(); n != local_noise_.end();) {
    const auto& group = noise_->group_of(*n);
    visit(group);
    n += group.count;
  }
}

std::vector<std::size_t> PhaseField::local_levels() const {
  std::vector<std::size_t> levels;
  if (shown_ != nullptr) {
    levels.resize(linalg::rank(comm_) == 0 ? x_.size() : 0);
    std::iota(levels.begin(), levels.end(), std::size_t{0});
    return levels;
  }
  for_each_group([&](const generator::Nodes::Group& group) {
    for (int i = group.first - lowest_; i <= group.last - lowest_; ++i) {
      levels.push_back(static_cast<std::size_t>(i));
    }
  });
  return levels;
}

// Functions are averages over the nodes at a force.
std::vector<double> PhaseField::rows_at(const model::Shown& shown) const {
  const std::size_t columns = v_.size();
  std::vector<double> all(static_cast<std::size_t>(noise_->count()) * columns, 0.0), rows;
  for (std::size_t n = 0; n < local_noise_.size(); ++n) {
    const auto place = static_cast<std::size_t>(local_noise_[n] - noise_->first());
    std::copy_n(by_node_.begin() + static_cast<std::ptrdiff_t>(n * columns), columns,
                all.begin() + static_cast<std::ptrdiff_t>(place * columns));
  }
  linalg::sum_over_ranks(comm_, all);
  for (std::size_t i = 0; i < shown.x.size() && linalg::rank(comm_) == 0; ++i) {
    const double whole = kind_ == Kind::function ? shown.at(i, probability_) : 1;
    for (std::size_t v = 0; v < columns; ++v) {
      double sum = 0;
      for (const auto& [node, share] : shown.of[i]) {
        const auto n = static_cast<std::size_t>(node);
        sum += share * all[n * columns + v] * (kind_ == Kind::function ? probability_[n] : 1);
      }
      rows.push_back(sum / whole);
    }
  }
  return rows;
}

std::vector<double> PhaseField::local_rows() const {
  if (shown_ != nullptr) return rows_at(*shown_);
  std::vector<double> rows;
  for_each_group([&](const generator::Nodes::Group& group) {
    const double* nodes = by_node_.data() + row_start(group.begin);
    for (int i = group.first; i <= group.last; ++i) {
      const auto shares = group.row(kind_ == Kind::function ? group.value : group.weight, i);
      for (std::size_t v = 0; v < v_.size(); ++v) {
        double sum = 0;
        for (std::size_t l = 0; l < shares.size(); ++l) sum += shares[l] * nodes[l * v_.size() + v];
        rows.push_back(sum);
      }
    }
  });
  return rows;
}

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
  const auto* shown = chain.shown();
  const bool several = shown == nullptr && !chain.neighbours_only();
  for (int i = chain.lowest(); i <= chain.highest() && several; ++i) {
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
    linalg::sum_over_ranks(distribution.states().comm(), *marginal);
  }
  field.cells.erase(field.cells.begin() + static_cast<std::ptrdiff_t>(field.cells.size() / 2) - 1);
  field.least = least_value(distribution.states().comm(), field.pdf);
  field.noise_marginal = noise->spread(noise_marginal);
  for (std::size_t i = 0; i < field.atom.size(); ++i) field.noise_marginal[i] += field.atom[i];
  const auto sums_at = [](const model::Shown& places, const std::vector<double>& by_node) {
    std::vector<double> sums;
    for (std::size_t i = 0; i < places.x.size(); ++i) sums.push_back(places.at(i, by_node));
    return sums;
  };
  if (chain.table != nullptr && chain.table->by_position() != nullptr) {
    const auto& places = *chain.table->by_position();
    field.position = {places.x, field.pdf.rows_at(places), sums_at(places, field.atom),
                      sums_at(places, field.noise_marginal)};
  }
  for (auto* marginal : {&field.atom, &field.noise_marginal}) {
    if (shown != nullptr) *marginal = sums_at(*shown, *marginal);
  }
  return field;
}

SpeedDistribution speed_distribution(const StationaryDistribution& distribution) {
  const double total = distribution.excursion().mean_excursion();
  const std::size_t nodes = distribution.discretisation().velocities->size();
  std::vector<double> sums(nodes + 2, 0.0);  // of the nodes, the origin and the holding states
  const linalg::ReadView local(distribution.occupation());
  PetscInt at = 0;
  distribution.states().for_each_local([&](const State& state) {
    std::size_t place = static_cast<std::size_t>(state.node);
    if (state.kind != StateKind::node) place = nodes + (state.kind == StateKind::holding ? 1 : 0);
    sums[place] += PetscRealPart(local[at++]) / total;
  });
  linalg::sum_over_ranks(distribution.states().comm(), sums);
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
