#pragma once
/// Numbering of the discrete states and their distribution over ranks.

#include <petscsys.h>

#include <span>
#include <vector>

#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/system_key.hpp"

namespace stickslip::generator {

/// What a state stands for.
enum class StateKind {
  node,         ///< sliding at a velocity node
  origin,       ///< (x_i, +-1, 0) beyond the static levels: a grid scheme keeps it, about to slide
  holding,      ///< at v_max, waiting for the noise to fall
  static_phase  ///< at rest, (x_i, 0, 0)
};

/// One state. The noise node of a sliding state counts along its own velocity branch: on the
/// negative branch n stands for the node -n, so that both branches look alike. A static state has a
/// noise level.
struct State {
  StateKind kind;
  Branch branch;  ///< positive for static states
  int noise;      ///< number of the noise node; of a static state the level
  int node;       ///< index on the velocity discretisation, for nodes
};

/// |v| in a state.
[[nodiscard]] inline double speed_of(const State& state, const VelocityDiscretisation& velocities) {
  if (state.kind == StateKind::node) return velocities.nodes()[state.node];
  return state.kind == StateKind::holding ? velocities.v_max() : 0;
}

/// The velocity for which a state stands, a grid scheme's at v = 0 for [0, v_1].
[[nodiscard]] inline double velocity_of(const State& state,
                                        const VelocityDiscretisation& velocities) {
  const bool origin = state.kind == StateKind::origin;
  const double speed = origin ? velocities.nodes()[0] / 2 : speed_of(state, velocities);
  return state.branch == Branch::positive ? speed : -speed;
}

/// The rate of a clock in a state.
[[nodiscard]] inline double rate_of(Clock clock, const State& state,
                                    const VelocityDiscretisation& velocities) {
  return rate_of(clock, std::abs(velocity_of(state, velocities)));
}

/// All states of a discretisation: for each velocity branch and noise node its velocity nodes and,
/// if it has them, an origin and a holding state; with `with_static_states` also the static states
/// on all their levels, of which reduction by even symmetry keeps 0 <= i <= k and by odd symmetry 1
/// <= i <= k.
///
/// States are numbered rank by rank; a rank owns whole groups of noise nodes, those of n and -n
/// together, which the reflection at v = 0 couples, with their static levels, and numbers its
/// states by velocity from low to high, noise fastest: incomplete factorisations need that order,
/// complete ones do not depend on it. Tables of the size of the noise on every rank, nothing of the
/// size of the grid.
class StateSpace {
 public:
  /// Collective on `comm`. Throws NoMemory when the states exceed PETSc's index type.
  StateSpace(MPI_Comm comm, const Discretisation& discretisation, Symmetry symmetry,
             bool with_static_states);

  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] Symmetry symmetry() const { return symmetry_; }
  [[nodiscard]] bool with_static_states() const { return with_static_states_; }
  [[nodiscard]] bool symmetry_reduced() const { return symmetry_ != Symmetry::none; }
  /// The velocity branches that are kept.
  [[nodiscard]] std::span<const Branch> branches() const;

  [[nodiscard]] PetscInt global_size() const { return global_size_; }
  [[nodiscard]] PetscInt local_size() const { return local_size_; }
  /// First global index of this rank.
  [[nodiscard]] PetscInt local_begin() const { return blocks_[rank_].begin; }
  /// Whether a global index is of this rank.
  [[nodiscard]] bool owns(PetscInt index) const {
    return local_begin() <= index && index < local_begin() + local_size_;
  }
  /// Noise nodes of this rank, rising.
  [[nodiscard]] const std::vector<int>& local_noise() const { return local_noise_; }

  /// The highest noise node that can stick.
  [[nodiscard]] int last_static(Branch branch) const { return side(branch).last_static; }
  [[nodiscard]] bool has_origin(Branch branch, int noise) const {
    return keeps_origin_ && noise > side(branch).last_static;
  }
  [[nodiscard]] bool has_holding(Branch branch, int noise) const {
    return noise >= side(branch).first_holding;
  }
  /// Whether the static level i is an unknown of its own.
  [[nodiscard]] bool has_static_state(int i) const {
    return with_static_states_ && i >= lowest_static_ && i <= highest_static_;
  }

  /// Global index of a state that exists. O(1).
  [[nodiscard]] PetscInt index(const State& state) const;

  /// Where the velocity nodes of a noise node lie: node j has the index first + j stride.
  struct NodeLine {
    PetscInt first, stride;
  };
  /// O(1).
  [[nodiscard]] NodeLine nodes_of(Branch branch, int noise) const;

  /// Calls visit(state) for the local states in the order of their indices.
  template <class Visit>
  void for_each_local(Visit visit) const {
    for (int row = first_row(); row <= last_row(); ++row) {
      if (row == 0) {
        visit_local_at_zero(visit);
        continue;
      }
      for (int n : local_noise_) {
        if (has_state(row, n)) visit(state_at(row, n));
      }
    }
  }

 private:
  // Noise nodes of a branch, counted along it.
  struct Side {
    Side(const model::Process& process, const Nodes& noise,
         const VelocityDiscretisation& velocities);
    int last_static;
    int first_holding;  // holding states exist from here on; last() + 1 if there are none
  };
  [[nodiscard]] const Side& side(Branch branch) const {
    return branch == Branch::positive ? upper_ : lower_;
  }

  // How many noise nodes a rank has, and how many states of other kinds; its first global index.
  struct Block {
    int nodes = 0, lower_holding = 0, lower_origins = 0, at_rest = 0;
    int upper_origins = 0, upper_holding = 0;
    PetscInt begin = 0;
  };
  void distribute(const Nodes& noise, const model::NoiseChain& chain);

  template <class Visit>
  void visit_local_at_zero(Visit visit) const {
    for (int n : local_noise_) {
      if (!symmetry_reduced() && has_origin(Branch::negative, -n)) {
        visit(State{StateKind::origin, Branch::negative, -n, 0});
      }
    }
    for (int i = lowest_static_; with_static_states_ && i <= highest_static_; ++i) {
      if (owner_of_static_[i - lowest_static_] == rank_) {
        visit(State{StateKind::static_phase, Branch::positive, i, 0});
      }
    }
    for (int n : local_noise_) {
      if (has_origin(Branch::positive, n)) visit(State{StateKind::origin, Branch::positive, n, 0});
    }
  }

  // Rows of equal velocity: 0 is v = 0, +-1 ... +-n the nodes, +-(n+1) the holding states.
  [[nodiscard]] int last_row() const { return nodes_ + 1; }
  [[nodiscard]] int first_row() const { return symmetry_reduced() ? 0 : -last_row(); }
  [[nodiscard]] bool has_state(int row, int n) const;
  [[nodiscard]] State state_at(int row, int n) const;
  [[nodiscard]] PetscInt size(const Block& block) const;

  MPI_Comm comm_;
  Symmetry symmetry_;
  bool with_static_states_, keeps_origin_;
  int first_, last_, nodes_;
  Side upper_, lower_;
  int lowest_static_, highest_static_;
  int rank_;
  std::vector<Block> blocks_;                         // by rank
  std::vector<int> owner_of_pair_, owner_of_static_;  // ranks of pairs n, -n and of static levels
  std::vector<int> place_, static_place_;             // among those of their rank, of noise nodes
  std::vector<int> local_noise_;
  PetscInt global_size_ = 0, local_size_ = 0;
};

}  // namespace stickslip::generator
