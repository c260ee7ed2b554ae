#include "stickslip/quantities/phase_field.hpp"

#include <algorithm>

#include "stickslip/operators/state_space.hpp"

namespace stickslip::quantities {

PhaseField::PhaseField(const model::Process& process, const velocity::Axis& axis,
                       const operators::StateSpace& states)
    : local_levels_(states.local_levels()) {
  const int n = process.noise.levels;
  for (int i = -n; i <= n; ++i) x_.push_back(process.noise.level(i));
  const auto nodes = axis.nodes();
  std::transform(nodes.rbegin(), nodes.rend(), std::back_inserter(v_),
                 [](double node) { return -node; });
  v_.insert(v_.end(), nodes.begin(), nodes.end());
  local_rows_.assign(local_levels_.size() * v_.size(), 0.0);
}

std::size_t PhaseField::row_start(int level) const {
  const auto place = std::lower_bound(local_levels_.begin(), local_levels_.end(), level);
  return static_cast<std::size_t>(place - local_levels_.begin()) * v_.size();
}

void PhaseField::add(operators::Half half, int level, int node, double value) {
  const std::size_t nodes = v_.size() / 2;
  const bool upper = half == operators::Half::upper;
  local_rows_[upper ? row_start(level) + nodes + node : row_start(-level) + nodes - 1 - node] +=
      value;
}

}  // namespace stickslip::quantities
