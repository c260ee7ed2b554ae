#pragma once
/// Numbering of the discrete states and their distribution over ranks.

#include <petscsys.h>

#include <cstdlib>
#include <span>
#include <vector>

#include "stickslip/operators/system_key.hpp"
#include "stickslip/petsc/factorization.hpp"
#include "stickslip/velocity/axis.hpp"

namespace stickslip::operators {

/// What a state stands for.
enum class StateKind {
  node,     ///< sliding at a velocity node
  origin,   ///< (x_i, +-1, 0) beyond the static levels: a grid scheme keeps it, about to slide
  holding,  ///< at v_max, waiting for the noise to fall
  rest      ///< static, (x_i, 0, 0)
};

/// One state. The level of a sliding state counts along its own half: on the lower half level l
/// stands for the noise x_{-l}, so that both halves look alike. The level of a state at rest is i.
struct State {
  StateKind kind;
  Half half;  ///< upper for states at rest
  int level;
  int node;  ///< index on the velocity axis, for nodes
};

/// All states of a discretisation: for each half and level its nodes and, if it has them, an origin
/// and a holding state; with `with_rest` also the static states, of which the even fold keeps
/// 0 <= i <= k and the odd one 1 <= i <= k.
///
/// States are numbered rank by rank; a rank owns whole shells {i, -i} of noise levels, which the
/// reflection at v = 0 couples, and numbers its states by velocity from low to high, noise levels
/// fastest: incomplete factorisations need that order, complete ones do not mind. Tables of size N
/// on every rank, nothing of the size of the grid.
class StateSpace {
 public:
  /// Collective on `comm`. Throws NoMemory when the states exceed PETSc's index type.
  StateSpace(MPI_Comm comm, const model::Process& process, const velocity::Axis& axis,
             Symmetry symmetry, bool with_rest);

  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] Symmetry symmetry() const { return symmetry_; }
  [[nodiscard]] bool with_rest() const { return with_rest_; }
  [[nodiscard]] bool folded() const { return symmetry_ != Symmetry::none; }
  /// Halves that are kept.
  [[nodiscard]] std::span<const Half> halves() const;

  [[nodiscard]] PetscInt global_size() const { return global_size_; }
  [[nodiscard]] PetscInt local_size() const { return local_size_; }
  /// First global index of this rank.
  [[nodiscard]] PetscInt local_begin() const { return blocks_[rank_].begin; }
  /// Whether this rank owns the levels i and -i.
  [[nodiscard]] bool owns(int level) const { return owner_of_shell_[std::abs(level)] == rank_; }
  /// Noise levels i owned by this rank, rising.
  [[nodiscard]] std::vector<int> local_levels() const;

  [[nodiscard]] bool has_origin(Half half, int level) const {
    return keeps_origin_ && level > side(half).k;
  }
  [[nodiscard]] bool has_holding(Half half, int level) const {
    return level >= side(half).first_holding;
  }
  /// Whether the static level i is an unknown of its own.
  [[nodiscard]] bool has_rest(int i) const {
    return with_rest_ && i >= lowest_rest_ && i <= upper_.k;
  }

  /// Global index of a state that exists. O(1).
  [[nodiscard]] PetscInt index(const State& state) const;

  /// Where the nodes of a level lie: node j has the index first + j stride.
  struct NodeLine {
    PetscInt first, stride;
  };
  /// O(1).
  [[nodiscard]] NodeLine nodes_of(Half half, int level) const;

  /// Where the nodes from ... from + size - 1 of a half begin in the local rows, in which they
  /// follow one another from low to high velocity, each on all local levels. Not for ranks without
  /// levels.
  [[nodiscard]] PetscInt strip(Half half, int from, int size) const;

  /// The local states by shells, which jumps of the noise couple with the next ones alone: in each
  /// those that fall towards v = 0, fast ones first, then states at rest, then those that rise;
  /// unfolded, all of level i before all of level -i, which meet at level 0 only.
  /// O(local states log(local states)).
  [[nodiscard]] petsc::Chain chain() const;
  /// For this chain, which is narrow on an hp axis; refers to this object.
  [[nodiscard]] petsc::Structure structure() const;

  /// Calls visit(state) for the local states in the order of their indices.
  template <class Visit>
  void for_each_local(Visit visit) const {
    const std::vector<int> levels = local_levels();
    for (int row = first_row(); row <= last_row(); ++row) {
      for (int i : levels) {
        if (has_state(row, i)) visit(state_at(row, i));
      }
    }
  }

 private:
  // Levels of a half, counted along it.
  struct Side {
    Side(const model::Process& process, const velocity::Axis& axis);
    int k;              // the highest that can stick
    int first_holding;  // holding states exist from here on; N + 1 if there are none
  };
  [[nodiscard]] const Side& side(Half half) const { return half == Half::upper ? upper_ : lower_; }

  // Shells [first, last) of a rank and its first global index.
  struct Block {
    int first, last;
    PetscInt begin;
  };

  // Rows of equal velocity: 0 is v = 0, +-1 ... +-n the nodes, +-(n+1) the holding states.
  [[nodiscard]] int last_row() const { return nodes_ + 1; }
  [[nodiscard]] int first_row() const { return folded() ? 0 : -last_row(); }
  [[nodiscard]] bool has_state(int row, int i) const;
  [[nodiscard]] State state_at(int row, int i) const;
  [[nodiscard]] int levels_below(const Block& block, int i) const;
  [[nodiscard]] int count(const Block& block, int row) const;
  [[nodiscard]] int position(const Block& block, int row, int i) const;
  [[nodiscard]] PetscInt row_offset(const Block& block, int row) const;
  [[nodiscard]] PetscInt size(const Block& block) const;

  MPI_Comm comm_;
  Symmetry symmetry_;
  bool with_rest_, keeps_origin_;
  int levels_, nodes_;
  Side upper_, lower_;
  int lowest_rest_;  // static states exist for i >= this
  int rank_;
  std::vector<Block> blocks_;        // by rank
  std::vector<int> owner_of_shell_;  // rank
  PetscInt global_size_ = 0, local_size_ = 0;
};

}  // namespace stickslip::operators
