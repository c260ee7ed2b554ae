#pragma once
/// Direct solution of lambda - L, element by element along the velocity.

#include <petscmat.h>

#include <utility>
#include <vector>

#include "stickslip/operators/element_system.hpp"
#include "stickslip/operators/state_space.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/preconditioner.hpp"

namespace stickslip::operators {

/// Block LU along the velocity for operators on an hp axis, on one rank. Elements are condensed to
/// the values at their ends, of which one a noise node crosses each end v_e: u+ (v_e) on nodes that
/// rise there, from above, and u- (v_e) on those that fall, from below. With the responses S of
/// element e, eliminated from v_max down,
///
///   u+(v_e) = R_e u-(v_e) + r_e,   R_e = S_ii + S_io R_(e+1) (1 - S_oo R_(e+1))^-1 S_oi,
///
/// R_e being what the half line above v_e reflects; at v_max holding states reflect. At v = 0 the
/// half lines meet each other and the states at rest, a tridiagonal chain eliminated before. With M
/// noise nodes and E elements of q velocity nodes, factors take some 1.3 E M^2 entries and 1.1 E
/// M^3 operations, besides those of the elements.
class ElementElimination final : public petsc::Preconditioner {
 public:
  /// For the matrix of a KolmogorovOperator with these states, kept by reference count, of which
  /// the rows of states at rest are read; the others follow from the discretisation. Local.
  /// O(noise levels).
  ElementElimination(const Discretisation& discretisation, const StateSpace& states, Mat matrix,
                     PetscScalar lambda);

  void factor(PetscScalar shift) override;
  void apply(Vec b, Vec x, bool transposed) const override;

 private:
  using Scalars = petsc::Scalars;
  using DenseMatrix = petsc::DenseMatrix;
  using DenseFactors = petsc::DenseFactors;

  // An element with the end beyond it.
  struct Link {
    ElementSystem element;
    DenseMatrix inner_outer, outer_inner, outer_outer;
    DenseMatrix reflection;  // R of the outer end
    DenseFactors turns;      // 1 - S_oo R
  };
  // A half line; lists by noise node count along it.
  struct Line {
    Half half = Half::upper;
    std::vector<double> excess;
    std::vector<PetscInt> first;  // by noise node, of its velocity nodes
    PetscInt stride = 0;
    std::vector<PetscInt> holding;  // rows of holding states, of the highest nodes
    std::vector<Link> links;
    DenseMatrix reflection;  // R at v = 0
    DenseMatrix hold_jumps;  // from holding states to nodes that fall at v_max
    DenseFactors hold;
    int rising = 0;                             // first node that rises at v = 0
    std::size_t falling_at = 0, rising_at = 0;  // of its nodes in lists over both half lines
  };
  // Levels at rest: a tridiagonal chain with its exits.
  struct RestChain {
    struct Exit {
      std::size_t level, node;  // of the chain; of all nodes that rise at v = 0
      PetscScalar rate;
    };
    struct Share {
      std::size_t node, level;  // of all nodes that fall at v = 0; of the chain
      double weight;
    };
    int lowest = 0;  // the level of the first row
    std::vector<PetscInt> rows;
    Scalars diagonal, below, above;  // LU: pivots, multipliers, upper diagonal
    std::vector<Exit> exits;
    std::vector<Share> shares;
    void factor();
    void solve(Scalars& x, bool transposed) const;
  };
  // What is known of a line while a right-hand side is in work, by end of elements from v = 0.
  struct Waves {
    explicit Waves(std::size_t elements) : f(elements + 1), up(elements + 1), down(elements + 1) {}
    std::vector<Scalars> f;         // of the elements; transposed, also of the holding states
    std::vector<Scalars> up, down;  // u+ and u-, or what is known of them yet
  };

  [[nodiscard]] Line line_of(Half half) const;
  [[nodiscard]] const velocity::HpAxis& axis_of(Half half) const;
  [[nodiscard]] int count() const { return discretisation_.noise->count(); }
  [[nodiscard]] int rising_at(const Line& line, int end) const;
  void predict_cost();
  void factor(Line& line) const;
  void hold(Line& line, DenseMatrix& reflection) const;
  void read_rest();
  void join();
  [[nodiscard]] std::size_t exit_of(PetscInt column) const;
  void place_rest_shares(const Line& line, int node, std::size_t row);

  [[nodiscard]] Scalars gathered(const Line& line, const ElementSystem& element,
                                 const PetscScalar* b) const;
  void scatter(const Line& line, const ElementSystem& element, const Scalars& u,
               PetscScalar* x) const;
  [[nodiscard]] Waves inwards(const Line& line, const PetscScalar* b) const;
  [[nodiscard]] Waves inwards_transposed(const Line& line, const PetscScalar* b) const;
  void outwards(const Line& line, Waves& waves, PetscScalar* x) const;
  void outwards_transposed(const Line& line, Waves& waves, PetscScalar* x) const;
  [[nodiscard]] Scalars rising_of(const Line& line, const Scalars& rising) const;
  void meet(std::vector<Waves>& waves, const PetscScalar* b, PetscScalar* x) const;
  void meet_transposed(std::vector<Waves>& waves, const PetscScalar* b, PetscScalar* x) const;

  Discretisation discretisation_;
  StateSpace states_;
  petsc::MatHandle matrix_;
  PetscScalar assembled_at_, lambda_ = 0;  // lambda before shifts and with them
  std::vector<Line> lines_;
  RestChain rest_;
  std::size_t falling_ = 0, rising_ = 0;  // nodes at v = 0, of all lines
  DenseMatrix meeting_;                   // C: values that fall to v = 0 find, from those that rise
  DenseFactors closed_;                   // 1 - C R
};

}  // namespace stickslip::operators
