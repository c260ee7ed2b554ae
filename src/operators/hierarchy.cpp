#include "stickslip/operators/hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "stickslip/velocity/hp_axis.hpp"

namespace stickslip::operators {
namespace {

using petsc::ElementModes;
using velocity::ReferenceElement;

// `falling`: nodes from the highest down, as on the lower half line.
std::shared_ptr<const ElementModes> modes_between(const ReferenceElement& fine,
                                                  const ReferenceElement& coarse, bool falling) {
  auto modes = std::make_shared<ElementModes>();
  const int q = fine.size, c = coarse.size;
  modes->nodes = q;
  modes->coarse_nodes = c;
  const std::size_t low = static_cast<std::size_t>(q) * c,
                    high = static_cast<std::size_t>(q) * (q - c);
  modes->prolong.resize(low);
  modes->restriction.resize(low);
  modes->from_high.resize(high);
  modes->to_high.resize(high);
  for (int m = 0; m < q; ++m) {
    const int row = falling ? q - 1 - m : m;
    const double t = fine.node[m], weight = fine.weight[m];
    const auto value = coarse.basis(t);
    for (int n = 0; n < c; ++n) {
      const int column = falling ? c - 1 - n : n;
      modes->prolong[row + q * column] = value[n];
      modes->restriction[column + c * row] = value[n] * weight / coarse.weight[n];
    }
    for (int k = c; k < q; ++k) {
      const double mode =
          std::sqrt(2.0 * k + 1) * std::legendre(static_cast<unsigned>(k), 2 * t - 1);
      modes->from_high[row + q * (k - c)] = mode;
      modes->to_high[k - c + (q - c) * row] = mode * weight;
    }
  }
  return modes;
}

}  // namespace

petsc::Hierarchy hierarchy(const StateSpace& fine, const velocity::Axis& axis,
                           const StateSpace& coarse, const velocity::Axis& coarse_axis) {
  const auto& elements = dynamic_cast<const velocity::HpAxis&>(axis);
  const auto& coarse_elements = dynamic_cast<const velocity::HpAxis&>(coarse_axis);
  petsc::Hierarchy hierarchy;
  const std::vector<int> levels = fine.local_levels();
  if (levels.empty()) return hierarchy;
  hierarchy.levels = static_cast<int>(levels.size());
  hierarchy.below = static_cast<int>(
      std::count_if(levels.begin(), levels.end(), [](int level) { return level < 0; }));
  hierarchy.centre = std::find(levels.begin(), levels.end(), 0) != levels.end();
  std::map<std::tuple<int, int, bool>, std::shared_ptr<const ElementModes>> known;
  for (Half half : fine.halves()) {
    const bool falling = half == Half::lower;
    for (int e = 0; e < elements.elements(); ++e) {
      const auto& [reference, node, length] = elements.element(e);
      const auto& [coarse_reference, coarse_node, same_length] = coarse_elements.element(e);
      const int q = reference->size, c = coarse_reference->size;
      auto& modes = known[{q, c, falling}];
      if (!modes) modes = modes_between(*reference, *coarse_reference, falling);
      hierarchy.strips.push_back(
          {modes, fine.strip(half, node, q), coarse.strip(half, coarse_node, c)});
    }
  }
  PetscInt row = 0;
  fine.for_each_local([&](const State& state) {
    if (state.kind != StateKind::node) {
      hierarchy.others.emplace_back(row, coarse.index(state) - coarse.local_begin());
    }
    ++row;
  });
  return hierarchy;
}

}  // namespace stickslip::operators
