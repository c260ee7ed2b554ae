#pragma once
/// Jumps along a chain of levels, at rates that are the same for all nodes of a level.

#include <petscsys.h>

#include <vector>

namespace stickslip::petsc {

/// What jumps are on the local levels, one entry each; their neighbours may be on other ranks.
struct LevelJumps {
  PetscScalar killing = 0;
  std::vector<double> to_above, to_below;      ///< rates of leaving for the next levels
  std::vector<double> from_above, from_below;  ///< rates of coming from these
  int gap = 0;  ///< the place whose level is not next to that before it; 0 if all are

  [[nodiscard]] int levels() const { return static_cast<int>(to_above.size()); }
  [[nodiscard]] double rate(int level) const { return to_above[level] + to_below[level]; }
};

/// J, the jumps and the killing between local levels, with what leaves for those of other ranks but
/// not where it goes:
///
///   (J u)_l = (killing + up_l + down_l) u_l - up_l u_{l+1} - down_l u_{l-1}.
///
/// Nothing is stored but the rates; a product takes 5 operations for each value. Not collective.
class Jumps {
 public:
  /// Local rows of nodes, on all levels each, one after the other by level, node by node.
  struct Nodes {
    PetscInt first;
    int count;
  };
  Jumps(LevelJumps jumps, std::vector<Nodes> nodes);

  [[nodiscard]] const LevelJumps& by_level() const { return jumps_; }

  /// y += J x, or J^T x.
  void add(const PetscScalar* x, PetscScalar* y, bool transposed) const;

  /// |J|.
  [[nodiscard]] Jumps sizes() const;

  /// Entries off the diagonal.
  [[nodiscard]] PetscInt64 entries() const;

 private:
  using Scalars = std::vector<PetscScalar>;
  // Entries of a row with local columns.
  struct Row {
    Scalars above, below;
  };
  LevelJumps jumps_;
  std::vector<Nodes> nodes_;
  Scalars diagonal_;
  Row plain_, transposed_;
};

}  // namespace stickslip::petsc
