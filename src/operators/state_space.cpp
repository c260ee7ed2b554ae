#include "stickslip/operators/state_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <tuple>

#include "stickslip/petsc/session.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::operators {
namespace {

int first_holding_level(const model::Process& process, const velocity::Axis& axis) {
  const int n = process.noise.levels;
  if (!axis.needs_holding()) return n + 1;
  const double drag = process.drag(axis.v_max());
  int first = n + 1;
  while (first > -n && process.excess(first - 1) + drag > 0) --first;
  return first;
}

int lowest_rest_level(Symmetry symmetry, const model::Process& process) {
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

StateSpace::Side::Side(const model::Process& process, const velocity::Axis& axis)
    : k(process.static_index()), first_holding(first_holding_level(process, axis)) {}

StateSpace::StateSpace(MPI_Comm comm, const model::Process& process, const velocity::Axis& axis,
                       Symmetry symmetry, bool with_rest)
    : comm_(comm),
      symmetry_(symmetry),
      with_rest_(with_rest),
      keeps_origin_(axis.keeps_origin()),
      levels_(process.noise.levels),
      nodes_(axis.size()),
      upper_(process, axis),
      lower_(process.mirrored(), axis),
      lowest_rest_(lowest_rest_level(symmetry, process)),
      rank_(petsc::rank(comm)) {
  require_countable((2.0 * levels_ + 1) * (2.0 * nodes_ + 3));
  // Shell s goes to the rank in whose equal share of the levels it begins.
  const std::int64_t ranks = petsc::ranks(comm), all = 2LL * levels_ + 1;
  for (int shell = 0; shell <= levels_; ++shell) {
    const std::int64_t before = shell == 0 ? 0 : 2LL * shell - 1;
    owner_of_shell_.push_back(static_cast<int>(before * ranks / all));
  }
  int first = 0;
  for (int r = 0; r < ranks; ++r) {
    int last = first;
    while (last <= levels_ && owner_of_shell_[last] == r) ++last;
    blocks_.push_back({first, last, global_size_});
    global_size_ += size(blocks_.back());
    first = last;
  }
  local_size_ = size(blocks_[rank_]);
}

std::span<const Half> StateSpace::halves() const {
  static constexpr std::array<Half, 2> both{Half::lower, Half::upper};
  return folded() ? std::span<const Half>(both).subspan(1) : std::span<const Half>(both);
}

std::vector<int> StateSpace::local_levels() const {
  const Block& block = blocks_[rank_];
  std::vector<int> levels;
  for (int i = 1 - block.last; i < block.last; ++i) {
    if (std::abs(i) >= block.first) levels.push_back(i);
  }
  return levels;
}

bool StateSpace::has_state(int row, int i) const {
  if (row == 0) {
    const bool below = !folded() && has_origin(Half::lower, -i);
    return has_rest(i) || has_origin(Half::upper, i) || below;
  }
  if (std::abs(row) <= nodes_) return true;
  return row > 0 ? has_holding(Half::upper, i) : has_holding(Half::lower, -i);
}

State StateSpace::state_at(int row, int i) const {
  if (row == 0 && has_rest(i)) return {StateKind::rest, Half::upper, i, 0};
  const Half half =
      row < 0 || (row == 0 && !has_origin(Half::upper, i)) ? Half::lower : Half::upper;
  const int level = half == Half::upper ? i : -i;
  if (row == 0) return {StateKind::origin, half, level, 0};
  if (std::abs(row) <= nodes_) return {StateKind::node, half, level, std::abs(row) - 1};
  return {StateKind::holding, half, level, 0};
}

// Number of levels of a rank below noise level i: they are -(last-1) ... -first, first ... last-1.
int StateSpace::levels_below(const Block& block, int i) const {
  const int lowest = 1 - block.last;
  const int negative = std::clamp(i - lowest, 0, block.last - std::max(block.first, 1));
  const int others = std::clamp(i - block.first, 0, block.last - block.first);
  return block.last == block.first ? 0 : negative + others;
}

// Number of states of a row on levels below noise level i.
int StateSpace::position(const Block& block, int row, int i) const {
  const auto below = [&](int level) { return levels_below(block, level); };
  if (row == 0) {
    int before = 0;
    const int first = upper_.k + 1;
    if (keeps_origin_ && !folded()) before += below(std::min(i, -lower_.k));
    if (with_rest_) before += below(std::clamp(i, lowest_rest_, first)) - below(lowest_rest_);
    if (keeps_origin_) before += below(std::max(i, first)) - below(first);
    return before;
  }
  if (std::abs(row) <= nodes_) return below(i);
  // Holding states belong to the highest levels of a half: on the lower one, the lowest noise.
  const int first = upper_.first_holding;
  if (row > 0) return below(std::max(i, first)) - below(first);
  return below(std::min(i, 1 - lower_.first_holding));
}

int StateSpace::count(const Block& block, int row) const {
  return position(block, row, levels_ + 1);
}

PetscInt StateSpace::row_offset(const Block& block, int row) const {
  const PetscInt node_row = levels_below(block, levels_ + 1);
  PetscInt offset = 0;
  if (!folded()) {
    if (row > -last_row()) offset += count(block, -last_row());
    offset += node_row * (std::clamp(row, -nodes_, 0) + nodes_);
  }
  if (row > 0) offset += count(block, 0) + node_row * (std::min(row, nodes_ + 1) - 1);
  return offset;
}

PetscInt StateSpace::size(const Block& block) const {
  return row_offset(block, last_row()) + count(block, last_row());
}

petsc::Chain StateSpace::chain() const {
  struct Entry {
    std::tuple<int, int, int, int> key;  // shell, arm, part of it, order there
    PetscInt row;
  };
  std::vector<Entry> entries;
  entries.reserve(static_cast<std::size_t>(local_size_));
  for_each_local([&](const State& s) {
    int height = 0;
    if (s.kind == StateKind::node) height = s.node + 1;
    if (s.kind == StateKind::holding) height = nodes_ + 1;
    const bool falls = s.level < 0;
    const int part = s.kind == StateKind::rest ? 1 : (falls ? 0 : 2);
    const int noise = s.half == Half::upper ? s.level : -s.level;
    const int arm = !folded() && noise < 0 ? 1 : 0;
    entries.push_back({{std::abs(s.level), arm, part, falls ? -height : height},
                       static_cast<PetscInt>(entries.size())});
  });
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.key < b.key; });
  petsc::Chain chain;
  for (std::size_t n = 0; n < entries.size(); ++n) {
    if (n > 0 && std::get<0>(entries[n].key) != std::get<0>(entries[n - 1].key)) {
      chain.start.push_back(static_cast<int>(n));
    }
    chain.rows.push_back(entries[n].row);
  }
  if (!entries.empty()) chain.start.push_back(static_cast<int>(entries.size()));
  return chain;
}

petsc::Structure StateSpace::structure() const {
  return {[this] { return chain(); }, !keeps_origin_};
}

StateSpace::NodeLine StateSpace::nodes_of(Half half, int level) const {
  const PetscInt first = index({StateKind::node, half, level, 0});
  return {first, nodes_ > 1 ? index({StateKind::node, half, level, 1}) - first : 0};
}

PetscInt StateSpace::strip(Half half, int from, int size) const {
  const Block& block = blocks_[rank_];
  const int row = half == Half::upper ? from + 1 : -(from + size);
  return row_offset(block, row);
}

PetscInt StateSpace::index(const State& state) const {
  const int sign = state.half == Half::upper ? 1 : -1;
  const int i = state.kind == StateKind::rest ? state.level : sign * state.level;
  const Block& block = blocks_[owner_of_shell_[std::abs(i)]];
  int row = 0;
  if (state.kind == StateKind::node) row = sign * (state.node + 1);
  if (state.kind == StateKind::holding) row = sign * last_row();
  return block.begin + row_offset(block, row) + position(block, row, i);
}

}  // namespace stickslip::operators
