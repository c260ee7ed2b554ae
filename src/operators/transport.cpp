#include "stickslip/operators/transport.hpp"

#include <map>
#include <memory>
#include <utility>

namespace stickslip::operators {
namespace {

// `falling`: nodes from the highest down, as on the lower half line.
std::shared_ptr<const petsc::TransportElement> in_rows(const velocity::ReferenceElement& r,
                                                       bool falling) {
  auto element = std::make_shared<petsc::TransportElement>();
  const int q = r.size;
  element->nodes = q;
  element->rows.resize(static_cast<std::size_t>(element->height()) * q);
  element->lifting.resize(2 * static_cast<std::size_t>(q));
  const auto place = [&](int node) { return falling ? q - 1 - node : node; };
  const auto entry = [&](int row, int node) -> PetscScalar& {
    return element->rows[row + element->height() * place(node)];
  };
  for (int m = 0; m < q; ++m) {
    double sum = 0;
    for (int n = 0; n < q; ++n) {
      if (n == m) continue;
      entry(place(m), n) = r.derivative[m * q + n];
      sum += r.derivative[m * q + n];
    }
    entry(place(m), m) = -sum;
    entry(q, m) = r.at_right[m];
    entry(q + 1, m) = r.at_left[m];
    element->lifting[place(m)] = r.at_right[m] / r.weight[m];
    element->lifting[q + place(m)] = r.at_left[m] / r.weight[m];
  }
  return element;
}

}  // namespace

petsc::Transport transport(const StateSpace& states, const model::Process& process,
                           const velocity::HpAxis& axis) {
  const std::vector<int> levels = states.local_levels();
  std::vector<petsc::TransportStrip> strips;
  std::map<std::pair<int, bool>, std::shared_ptr<const petsc::TransportElement>> known;
  for (Half half : states.halves()) {
    if (levels.empty()) break;
    const bool falling = half == Half::lower;
    const model::Process side = falling ? process.mirrored() : process;
    std::vector<double> excess;
    for (int i : levels) excess.push_back(side.excess(falling ? -i : i));
    const auto shared = std::make_shared<const std::vector<double>>(std::move(excess));
    for (int e = 0; e < axis.elements(); ++e) {
      const auto& [reference, first, length] = axis.element(e);
      auto& element = known[{reference->size, falling}];
      if (!element) element = in_rows(*reference, falling);
      petsc::TransportStrip strip;
      strip.element = element;
      strip.first = states.strip(half, first, reference->size);
      strip.length = length;
      for (int m = 0; m < reference->size; ++m) {
        const int node = falling ? reference->size - 1 - m : m;
        strip.drag.push_back(side.drag(axis.nodes()[first + node]));
      }
      strip.drag_at_inner = side.drag(axis.cells()[e]);
      strip.drag_at_outer = side.drag(axis.cells()[e + 1]);
      const int here = static_cast<int>(strips.size());
      if (e > 0) strip.inner = here - 1;
      if (e + 1 < axis.elements()) strip.outer = here + 1;
      strip.excess = shared;
      strips.push_back(std::move(strip));
    }
  }
  return {static_cast<int>(levels.size()), std::move(strips)};
}

// Rates are those of the noise on both halves, whose levels are listed alike.
petsc::Jumps jumps(const StateSpace& states, const model::Process& process,
                   const velocity::Axis& axis, PetscScalar lambda) {
  const auto& noise = process.noise;
  const auto up = [&noise](int i) { return noise.rate() * noise.up(i); };
  const auto down = [&noise](int i) { return noise.rate() * noise.down(i); };
  petsc::LevelJumps by_level;
  by_level.killing = lambda;
  const std::vector<int> levels = states.local_levels();
  for (std::size_t a = 0; a < levels.size(); ++a) {
    const int i = levels[a];
    const bool top = i == noise.levels, bottom = i == -noise.levels;
    if (a > 0 && i != levels[a - 1] + 1) by_level.gap = static_cast<int>(a);
    by_level.to_above.push_back(top ? 0 : up(i));
    by_level.to_below.push_back(bottom ? 0 : down(i));
    by_level.from_above.push_back(top ? 0 : down(i + 1));
    by_level.from_below.push_back(bottom ? 0 : up(i - 1));
  }
  std::vector<petsc::Jumps::Nodes> nodes;
  if (!levels.empty()) {
    for (Half half : states.halves()) {
      nodes.push_back({states.strip(half, 0, axis.size()), axis.size()});
    }
  }
  return {std::move(by_level), std::move(nodes)};
}

}  // namespace stickslip::operators
