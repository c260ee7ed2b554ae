#include "stickslip/petsc/jumps.hpp"

#include <utility>

#include "stickslip/petsc/dense.hpp"

namespace stickslip::petsc {

Jumps::Jumps(LevelJumps jumps, std::vector<Nodes> nodes)
    : jumps_(std::move(jumps)), nodes_(std::move(nodes)) {
  const int levels = jumps_.levels();
  for (int a = 0; a < levels; ++a) {
    const bool last = a + 1 == levels || a + 1 == jumps_.gap, first = a == 0 || a == jumps_.gap;
    diagonal_.push_back(jumps_.killing + jumps_.rate(a));
    plain_.above.push_back(last ? 0 : -jumps_.to_above[a]);
    plain_.below.push_back(first ? 0 : -jumps_.to_below[a]);
    transposed_.above.push_back(last ? 0 : -jumps_.from_above[a]);
    transposed_.below.push_back(first ? 0 : -jumps_.from_below[a]);
  }
}

void Jumps::add(const PetscScalar* x, PetscScalar* y, bool transposed) const {
  const Row& row = transposed ? transposed_ : plain_;
  const PetscScalar *diagonal = diagonal_.data(), *above = row.above.data(),
                    *below = row.below.data();
  const int levels = jumps_.levels();
  for (const auto& [first, count] : nodes_) {
    for (int n = 0; n < count; ++n) {
      const PetscScalar* from = x + first + static_cast<std::ptrdiff_t>(levels) * n;
      PetscScalar* to = y + first + static_cast<std::ptrdiff_t>(levels) * n;
      for (int a = 0; a < levels; ++a) to[a] += diagonal[a] * from[a];
      for (int a = 0; a + 1 < levels; ++a) to[a] += above[a] * from[a + 1];
      for (int a = 1; a < levels; ++a) to[a] += below[a] * from[a - 1];
    }
  }
}

Jumps Jumps::sizes() const {
  Jumps bound = *this;
  take_sizes(bound.diagonal_);
  for (Row* row : {&bound.plain_, &bound.transposed_}) {
    take_sizes(row->above);
    take_sizes(row->below);
  }
  return bound;
}

PetscInt64 Jumps::entries() const {
  const int levels = jumps_.levels();
  if (levels == 0) return 0;
  const PetscInt64 pairs = levels - 1 - (jumps_.gap > 0 ? 1 : 0);
  PetscInt64 nodes = 0;
  for (const Nodes& part : nodes_) nodes += part.count;
  return 2 * pairs * nodes;
}

}  // namespace stickslip::petsc
