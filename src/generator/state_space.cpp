#include "stickslip/generator/state_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "stickslip/base/errors.hpp"
#include "stickslip/linalg/session.hpp"

namespace stickslip::generator {

// Functions of the noise are not smooth on the levels that do not move at that speed.
Discretisation Discretisation::cut_at(double speed, bool beyond,
                                      std::optional<model::Passage> killed) const {
  const auto standing = [speed](const model::Process& branch) {
    return branch.friction.at_rest() - branch.bias - branch.drag(speed);
  };
  Grouping grouping = noise->grouping();
  grouping.special = {standing(process), -standing(process.mirrored())};
  const auto kills = [killed](model::Passage side) {
    return killed == side || killed == model::Passage::both;
  };
  const bool up = kills(model::Passage::up), down = kills(model::Passage::down);
  return {process, velocities->cut_at(speed, beyond, up, down),
          std::make_shared<Nodes>(process, grouping)};
}

namespace {

int first_holding_node(const model::Process& process, const Nodes& noise,
                       const VelocityDiscretisation& velocities) {
  int first = noise.last() + 1;
  if (!velocities.needs_holding()) return first;
  const double drag = process.drag(velocities.v_max());
  while (first > noise.first() && process.net_force_at(noise.x(first - 1)) + drag > 0) --first;
  return first;
}

int lowest_static_level(Symmetry symmetry, const model::Process& process) {
  switch (symmetry) {
  case Symmetry::even: return 0;
  case Symmetry::odd: return 1;  // an odd function vanishes at x = 0 at rest
  case Symmetry::none: break;
  }
  return process.lowest_static();
}

void require_countable(double states) {
  if (states < std::numeric_limits<PetscInt>::max()) return;
  throw NoMemory(fmt::format("{:.3g} unknowns exceed the {}-bit indices of this PETSc", states,
                             8 * sizeof(PetscInt)));
}

}  // namespace

StateSpace::Side::Side(const model::Process& process, const Nodes& noise,
                       const VelocityDiscretisation& velocities)
    : last_static(noise.last_up_to(process.highest_static())),
      first_holding(first_holding_node(process, noise, velocities)) {}

StateSpace::StateSpace(MPI_Comm comm, const Discretisation& discretisation, Symmetry symmetry,
                       bool with_static_states)
    : comm_(comm),
      symmetry_(symmetry),
      with_static_states_(with_static_states),
      keeps_origin_(discretisation.velocities->keeps_origin()),
      first_(discretisation.noise->first()),
      last_(discretisation.noise->last()),
      nodes_(discretisation.velocities->size()),
      upper_(discretisation.process, *discretisation.noise, *discretisation.velocities),
      lower_(discretisation.process.mirrored(), discretisation.noise->mirrored(),
             discretisation.velocities->mirrored()),
      lowest_static_(lowest_static_level(symmetry, discretisation.process)),
      highest_static_(discretisation.process.highest_static()),
      rank_(linalg::rank(comm)) {
  require_countable(discretisation.noise->count() * (2.0 * nodes_ + 2) +
                    discretisation.process.noise.count());
  distribute(*discretisation.noise, discretisation.process.noise);
  for (int n = first_; n <= last_; ++n) {
    if (owner_of_pair_[std::abs(n)] == rank_) local_noise_.push_back(n);
  }
  local_size_ = size(blocks_[rank_]);
}

// A group goes to the rank in whose equal share of the nodes it begins, and takes its levels along.
// Groups that -x does not map to groups stay together.
void StateSpace::distribute(const Nodes& noise, const model::NoiseChain& chain) {
  const std::int64_t ranks = linalg::ranks(comm_), all = noise.count();
  const bool together = !chain.symmetric() && !noise.all_levels();
  const int pairs = std::max(-first_, last_);
  for (int pair = 0; pair <= pairs; ++pair) {
    const int begin = together || noise.all_levels() ? pair : noise.group_of(pair).begin;
    const std::int64_t before = together || pair == 0 ? 0 : 2LL * begin - 1;
    owner_of_pair_.push_back(static_cast<int>(std::min(before * ranks / all, ranks - 1)));
  }
  blocks_.resize(static_cast<std::size_t>(ranks));
  for (int n = first_; n <= last_; ++n) {
    Block& block = blocks_[owner_of_pair_[std::abs(n)]];
    place_.push_back(block.nodes++);
    block.upper_origins += has_origin(Branch::positive, n) ? 1 : 0;
    block.upper_holding += has_holding(Branch::positive, n) ? 1 : 0;
    if (symmetry_reduced()) continue;
    block.lower_origins += has_origin(Branch::negative, -n) ? 1 : 0;
    block.lower_holding += has_holding(Branch::negative, -n) ? 1 : 0;
  }
  for (int i = lowest_static_; with_static_states_ && i <= highest_static_; ++i) {
    const int level = std::abs(i), pair = noise.all_levels() ? level
                                          : together         ? 0
                                                             : noise.group_at(level).begin;
    owner_of_static_.push_back(owner_of_pair_[pair]);
    static_place_.push_back(blocks_[owner_of_static_.back()].at_rest++);
  }
  for (Block& block : blocks_) {
    block.begin = global_size_;
    global_size_ += size(block);
  }
}

std::span<const Branch> StateSpace::branches() const {
  static constexpr std::array<Branch, 2> both{Branch::negative, Branch::positive};
  return symmetry_reduced() ? std::span<const Branch>(both).subspan(1)
                            : std::span<const Branch>(both);
}

// Away from v = 0.
bool StateSpace::has_state(int row, int n) const {
  if (std::abs(row) <= nodes_) return true;
  return row > 0 ? has_holding(Branch::positive, n) : has_holding(Branch::negative, -n);
}

State StateSpace::state_at(int row, int n) const {
  const Branch branch = row < 0 ? Branch::negative : Branch::positive;
  const int along = row < 0 ? -n : n;
  if (std::abs(row) <= nodes_) return {StateKind::node, branch, along, std::abs(row) - 1};
  return {StateKind::holding, branch, along, 0};
}

PetscInt StateSpace::size(const Block& block) const {
  const PetscInt sliding = static_cast<PetscInt>(block.nodes) * nodes_;
  return (symmetry_reduced() ? 1 : 2) * sliding + block.lower_holding + block.lower_origins +
         block.at_rest + block.upper_origins + block.upper_holding;
}

StateSpace::NodeLine StateSpace::nodes_of(Branch branch, int noise) const {
  const PetscInt first = index({StateKind::node, branch, noise, 0});
  return {first, nodes_ > 1 ? index({StateKind::node, branch, noise, 1}) - first : 0};
}

// By velocity: holding states and nodes of the negative branch; at v = 0 its origins, static
// states, origins of the positive branch; nodes and holding states of that. Not all noise nodes
// have origins and holding states, but on the negative branch the lowest ones and on the positive
// the highest.
PetscInt StateSpace::index(const State& state) const {
  const bool upper = state.branch == Branch::positive,
             rests = state.kind == StateKind::static_phase;
  const int n = upper ? state.noise : -state.noise, place = rests ? 0 : place_[n - first_];
  const Block& block =
      blocks_[rests ? owner_of_static_[n - lowest_static_] : owner_of_pair_[std::abs(n)]];
  const PetscInt nodes = block.nodes, sliding = nodes * nodes_,
                 zero = block.begin + (symmetry_reduced() ? 0 : block.lower_holding + sliding),
                 above = zero + block.lower_origins + block.at_rest + block.upper_origins;
  switch (state.kind) {
  case StateKind::static_phase:
    return zero + block.lower_origins + static_place_[n - lowest_static_];
  case StateKind::origin: return place + (upper ? above - nodes : zero);
  case StateKind::holding:
    return place + (upper ? above + sliding - nodes + block.upper_holding : block.begin);
  case StateKind::node: break;
  }
  return place + (upper ? above + nodes * state.node : zero - nodes * (state.node + 1));
}

}  // namespace stickslip::generator
