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
std::shared_ptr<const Nodes> Discretisation::nodes_for(double speed) const {
  const auto standing = [speed](const model::Process& branch) {
    return branch.friction.at_rest() - branch.bias - branch.drag(speed);
  };
  Grouping grouping = noise->grouping();
  grouping.special = {standing(process), -standing(process.mirrored())};
  return std::make_shared<Nodes>(process, grouping);
}

Discretisation Discretisation::killing_at(double speed) const {
  return {process, velocities->killing_at(speed), nodes_for(speed)};
}

Discretisation Discretisation::passing(double speed, std::optional<model::Passage> killed) const {
  const auto kills = [killed](model::Passage side) {
    return killed == side || killed == model::Passage::both;
  };
  const bool up = kills(model::Passage::up), down = kills(model::Passage::down);
  return {process, velocities->passing(speed, up, down), nodes_for(speed)};
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

// Of {-(last-1) ... -first, first ... last-1} in [lowest, highest], those below n.
int below_in_pairs(int first, int last, int lowest, int highest, int n) {
  const auto below = [&](int from, int to) {
    from = std::max(from, lowest);
    to = std::min(to, highest);
    return std::clamp(n - from, 0, std::max(to - from + 1, 0));
  };
  return below(1 - last, -std::max(first, 1)) + below(first, last - 1);
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
  const Block& block = blocks_[rank_];
  for (int n = first_; n <= last_; ++n) {
    if (std::abs(n) >= block.first && std::abs(n) < block.last) local_noise_.push_back(n);
  }
  local_size_ = size(block);
}

// A group goes to the rank in whose equal share of the nodes it begins, and takes its levels along.
// Groups that -x does not map to groups stay together.
void StateSpace::distribute(const Nodes& noise, const model::NoiseChain& chain) {
  const std::int64_t ranks = linalg::ranks(comm_), all = noise.count();
  const bool together = !chain.symmetric() && !noise.all_levels();
  const int pairs = std::max(-first_, last_), levels = std::max(-chain.lowest(), chain.highest());
  const auto innermost = [&](int pair) {
    return noise.all_levels() ? pair : noise.group_of(pair).begin;
  };
  for (int pair = 0; pair <= pairs; ++pair) {
    const std::int64_t before = together || pair == 0 ? 0 : 2LL * innermost(pair) - 1;
    owner_of_pair_.push_back(static_cast<int>(std::min(before * ranks / all, ranks - 1)));
  }
  int first = 0, first_static = 0;
  for (int r = 0; r < ranks; ++r) {
    int last = first, last_static = levels + 1;
    while (last <= pairs && owner_of_pair_[last] == r) ++last;
    if (last <= pairs) last_static = noise.all_levels() ? last : noise.group_of(last).first;
    blocks_.push_back({first, last, first_static, last_static, global_size_});
    global_size_ += size(blocks_.back());
    first = last;
    first_static = last_static;
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

int StateSpace::owner_of_static_level(int level) const {
  const auto after =
      std::partition_point(blocks_.begin(), blocks_.end(), [level](const Block& block) {
        return block.last_static <= std::abs(level);
      });
  return static_cast<int>(after - blocks_.begin());
}

int StateSpace::nodes_below(const Block& block, int n) const {
  return below_in_pairs(block.first, block.last, first_, last_, n);
}

// Static states of a rank below a level.
int StateSpace::static_levels_below(const Block& block, int level) const {
  if (!with_static_states_) return 0;
  return below_in_pairs(block.first_static, block.last_static, lowest_static_, highest_static_,
                        level);
}

// Number of states of a row of a rank before a state: at v = 0 origins of the negative branch,
// static states, origins of the positive branch.
int StateSpace::position(const Block& block, int row, const State& state) const {
  const auto below = [&](int n) { return nodes_below(block, n); };
  const int n = state.branch == Branch::positive ? state.noise : -state.noise;
  const int first_lower = -lower_.last_static, first_upper = upper_.last_static + 1;
  const int lower_origins = keeps_origin_ && !symmetry_reduced() ? below(first_lower) : 0;
  switch (state.kind) {
  case StateKind::node: return below(n);
  case StateKind::holding:
    // The highest nodes of a branch: on the negative one, the lowest of the noise.
    return row > 0 ? below(n) - below(upper_.first_holding) : below(n);
  case StateKind::static_phase: return lower_origins + static_levels_below(block, state.noise);
  case StateKind::origin: break;
  }
  if (state.branch == Branch::negative) return below(n);
  const int at_rest = static_levels_below(block, highest_static_ + 1);
  return lower_origins + at_rest + below(n) - below(first_upper);
}

int StateSpace::size_at_zero(const Block& block) const {
  int count = static_levels_below(block, highest_static_ + 1);
  if (!keeps_origin_) return count;
  const int all = nodes_below(block, last_ + 1);
  if (!symmetry_reduced()) count += nodes_below(block, -lower_.last_static);
  return count + all - nodes_below(block, upper_.last_static + 1);
}

int StateSpace::count(const Block& block, int row) const {
  const int all = nodes_below(block, last_ + 1);
  if (row == 0) return size_at_zero(block);
  if (std::abs(row) <= nodes_) return all;
  if (row > 0) return all - nodes_below(block, upper_.first_holding);
  return nodes_below(block, 1 - lower_.first_holding);
}

PetscInt StateSpace::row_offset(const Block& block, int row) const {
  const PetscInt node_row = nodes_below(block, last_ + 1);
  PetscInt offset = 0;
  if (!symmetry_reduced()) {
    if (row > -last_row()) offset += count(block, -last_row());
    offset += node_row * (std::clamp(row, -nodes_, 0) + nodes_);
  }
  if (row > 0) offset += count(block, 0) + node_row * (std::min(row, nodes_ + 1) - 1);
  return offset;
}

PetscInt StateSpace::size(const Block& block) const {
  return row_offset(block, last_row()) + count(block, last_row());
}

StateSpace::NodeLine StateSpace::nodes_of(Branch branch, int noise) const {
  const PetscInt first = index({StateKind::node, branch, noise, 0});
  return {first, nodes_ > 1 ? index({StateKind::node, branch, noise, 1}) - first : 0};
}

PetscInt StateSpace::index(const State& state) const {
  const int sign = state.branch == Branch::positive ? 1 : -1;
  const int owner = state.kind == StateKind::static_phase ? owner_of_static_level(state.noise)
                                                          : owner_of_pair_[std::abs(state.noise)];
  const Block& block = blocks_[owner];
  int row = 0;
  if (state.kind == StateKind::node) row = sign * (state.node + 1);
  if (state.kind == StateKind::holding) row = sign * last_row();
  return block.begin + row_offset(block, row) + position(block, row, state);
}

}  // namespace stickslip::generator
