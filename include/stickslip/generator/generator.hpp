#pragma once
/// lambda - L on discrete states: the operator of every backward Kolmogorov equation solved here.

#include <petscmat.h>
#include <petscvec.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/state_space.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::generator {

// What travels with the matrix of an operator, for preconditioners that use it.

/// What a matrix is of: -L and what is added to it.
struct MatrixData {
  Discretisation discretisation;
  StateSpace states;
  Shift<PetscScalar> shift;
};

/// The data of a matrix; null if it has none. Not collective.
[[nodiscard]] std::shared_ptr<const MatrixData> data_of(Mat matrix);

/// How a row is coupled to a static state.
struct StaticCoupling {
  PetscInt row;  ///< local
  int level;     ///< static level i
  double rate;
};

/// How a row is coupled to the largest speed, where bodies are killed.
struct TopCoupling {
  PetscInt row;  ///< local
  double rate;
};

/// A = lambda - L. On noise node l of a velocity branch, with B_l(v) = x_l + g - mu_d + b(v) on the
/// positive one and that of the mirrored process on the negative one, J the jump matrix of
/// Nodes,
///
///   (A u)_l = lambda u_l - B_l u_l' - sum_m J_lm u_m,
///
/// and where the flow reaches v = 0 the value met there is
///   static l:    sum_i T_il s_i of the static values s,
///   l below:     u(0+) on node -l of the other branch, or +- that on the same branch when
///   symmetry-reduced.
/// Nodes that leave v = 0 need no condition. Static values live on all their levels and follow the
/// noise until it jumps to a level that does not stick: to s+- = (x, +-1, 0), x the level next to
/// them, x_{+-(k+1)} without bias, where it jumps to neighbours.
///
/// Diagonals are summed from the off-diagonals of their row in the order of columns, so that with
/// StaticPhase::kept and lambda = 0 row sums are exactly zero. On an upwind velocity discretisation
/// the off-diagonals of -A are >= 0 and a row has at most five entries if every level is a node:
/// with both branches and kept, -A then is the generator M of the paper's section 5.
///
/// By the clock of path length lambda is multiplied by |v|, and a tilt times v is subtracted; where
/// the velocity discretisation kills at its top, u = 0 there.
class KolmogorovOperator {
 public:
  /// Assembles the local rows. The matrix lives as long as the operator. By a parameter theta
  /// dA/dtheta, without shift and for StaticPhase::killing: entry_rates and from_static are those
  /// of -dA_us/dtheta. Elements, nodes and upwind directions stay as they are: what is projected is
  /// the derivative of the process. Collective. O(local nonzeros).
  KolmogorovOperator(MPI_Comm comm, const Discretisation& discretisation, Shift<PetscScalar> shift,
                     Symmetry symmetry, StaticPhase static_phase,
                     const std::optional<model::Derivative>& derivative = {});

  [[nodiscard]] const Discretisation& discretisation() const { return data_->discretisation; }
  [[nodiscard]] const StateSpace& states() const { return data_->states; }
  /// Carries the MatrixData of the operator.
  [[nodiscard]] Mat matrix() const { return matrix_; }
  /// The matrix at lambda + by, by the clock of time, with the MatrixData that belong to it.
  /// Collective. A copy of the matrix.
  [[nodiscard]] linalg::MatHandle shifted(PetscScalar by) const;
  [[nodiscard]] PetscInt64 nonzeros() const { return nonzeros_; }

  /// Kills in one sliding state s at a rate kappa, for a body that never rests, where nothing else
  /// kills and -L is singular. A process that starts anew in s whenever it is killed there is the
  /// one without killing: nu (-L + kappa e_s e_s^T) = e_s has the solution with nu L = 0, as the
  /// rows of L sum to zero, and nu_s = 1/kappa. A state of a middle speed on the level next to the
  /// mean. The matrix is no longer that of its MatrixData. Collective.
  void kill_in_one_state();
  [[nodiscard]] bool kills_in_one_state() const { return killing_state_.has_value(); }
  /// u -> u(s). Collective.
  [[nodiscard]] linalg::VecHandle value_in_that_state() const;

  /// The functional u -> u(x, +-1, 0) as a vector, x a level from which excursions start.
  /// Collective.
  [[nodiscard]] linalg::VecHandle trace_at_start(int level) const;
  /// The same on the most frequent of these levels, s+ (positive) or s- (negative; with both
  /// branches only) where the noise jumps to neighbours; if all excursions start on the other side,
  /// there. Collective.
  [[nodiscard]] linalg::VecHandle trace_at_exit(Branch branch = Branch::positive) const;

  /// The functional u -> sum_i p_i u(x_i, v), p by level from the lowest up, v = 0 being s+- for
  /// |i| > k and rest for |i| <= k; symmetry-reduced, from the branch that is kept. Static states
  /// must be kept. Collective. O(levels).
  [[nodiscard]] linalg::VecHandle mean_at(const std::vector<double>& p, double v = 0) const;

  /// nu -> -nu A_us, from the lowest static level up: the rate at which an occupation flows into
  /// each static level; the same on all ranks. StaticPhase::killing only. Collective.
  [[nodiscard]] std::vector<PetscScalar> entry_rates(Vec nu) const;
  /// The rate at which states flow over the largest speed, where bodies are killed. Collective.
  [[nodiscard]] linalg::VecHandle rates_to_top() const;
  /// The rate at which an occupation flows over the largest speed, where bodies are killed; the
  /// same on all ranks. Collective.
  [[nodiscard]] double rate_at_top(Vec nu) const;
  /// -A_us s, a right-hand side: what static values s, from the lowest level up, send into the
  /// sliding states.
  /// StaticPhase::killing only. Collective.
  [[nodiscard]] linalg::VecHandle from_static(const std::vector<PetscScalar>& s) const;

  /// L u^2 - 2 u L u, the squares of what u changes by at jumps times their rates, u having the
  /// values s at rest and 0 where bodies are killed at a speed: where -L u = 1, the rate at which
  /// the variance of the time until then grows. Of lambda = 0; StaticPhase::killing only.
  /// Collective.
  [[nodiscard]] linalg::VecHandle square_field(Vec u, const std::vector<double>& s) const;

  /// f(x, y, v) on all states, projected on noise nodes: products with occupations are those of
  /// the measures that they stand for, whatever f is; on nodes of noise of continuous paths if f is
  /// smooth, or `averaged`. Collective. O(levels velocity nodes), averaged a hundred times that.
  using Observable = model::Observable::Function;
  [[nodiscard]] linalg::VecHandle values(const Observable& f, bool averaged = false) const;
  /// f(state) on all states. Collective.
  template <class Function>
  [[nodiscard]] linalg::VecHandle by_state(Function f) const {
    linalg::VecHandle result = zeros();
    linalg::WriteView local(result);
    PetscInt at = 0;
    states().for_each_local([&](const State& state) { local[at++] = f(state); });
    return result;
  }
  /// What sums over velocity nodes overlook of f, by VelocityDiscretisation::overlooked: the
  /// product with an occupation, or u(s+) where (lambda - L) u is this, is an error of what
  /// values(f) gives. Other nodes would see it, and no refinement need. Zero where f is a
  /// polynomial in v of the degree of the elements. Collective. Three times the cost of values().
  [[nodiscard]] linalg::VecHandle overlooked(const Observable& f) const;
  /// A vector of the operator's layout, zero. Collective.
  [[nodiscard]] linalg::VecHandle zeros() const;

 private:
  // The nodes by which states of a branch are counted.
  [[nodiscard]] const Nodes& nodes_along(Branch branch) const {
    const auto& nodes = *discretisation().noise;
    return branch == Branch::positive ? nodes : nodes.mirrored();
  }

  // What fill(add) adds up by add(state, weight), on any rank.
  template <class Fill>
  [[nodiscard]] linalg::VecHandle functional(Fill fill) const;
  // Adds weight times the value at (x_i, v).
  template <class Add>
  void add_value_at(int i, double v, double weight, const Add& add) const;

  std::shared_ptr<MatrixData> data_;
  std::map<int, std::vector<std::pair<PetscInt, double>>> traces_;  // by level
  std::vector<StaticCoupling> static_coupling_;                     // -A_us
  std::vector<TopCoupling> top_coupling_;
  // The matrix of a single rank lives in these.
  std::vector<PetscInt> row_start_, columns_;
  std::vector<PetscScalar> values_;
  linalg::MatHandle matrix_;
  PetscInt64 nonzeros_ = 0;
  std::optional<PetscInt> killing_state_;
};

/// The part of f that belongs to a symmetry; f itself where there is none. It refers to f.
[[nodiscard]] inline KolmogorovOperator::Observable part_of(const model::Observable& f,
                                                            Symmetry symmetry) {
  switch (symmetry) {
  case Symmetry::even:
    return [&f](const model::Place& x, double y, double v) { return f.even(x, y, v); };
  case Symmetry::odd:
    return [&f](const model::Place& x, double y, double v) { return f.odd(x, y, v); };
  case Symmetry::none: break;
  }
  return f.value;
}

/// The part of f that has a stationary average: where mirrored states are as likely, odd functions
/// have exactly none. It refers to f.
[[nodiscard]] inline KolmogorovOperator::Observable part_with_mean(const model::Observable& f,
                                                                   const model::Process& process) {
  return part_of(f, process.drifts() ? Symmetry::none : Symmetry::even);
}

// What holds of every generator and every occupation, whatever the model parameters: where it
// fails, the program is at fault, and no number is given.

/// Rows of A = lambda - L that one rank has, by columns in rising order with the diagonal.
struct LocalRows {
  PetscInt first;  ///< global number of the first row
  std::span<const PetscInt> row_start, columns;
  std::span<const PetscScalar> values;
};

/// What a discretisation promises of its rows.
struct Promise {
  bool monotone;  ///< off-diagonals of -A >= 0 and row sums >= 0: an upwind velocity discretisation
  bool conservative;  ///< row sums are zero: nothing is killed and lambda = 0
};

/// Throws NotReached, with the row and the model parameters to report, if a promise is broken on
/// any rank. Collective. O(nonzeros).
void require_generator(MPI_Comm comm, const LocalRows& rows, Promise promise,
                       const model::Process& process);

/// Throws NotReached, with the model parameters to report, if an occupation has entries below zero
/// by more than rounding, 1e-9 of the largest one: on a monotone velocity discretisation there are
/// none. Collective. O(size).
void require_occupation(Vec nu, const model::Process& process);

}  // namespace stickslip::generator
