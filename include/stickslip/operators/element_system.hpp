#pragma once
/// lambda - L on one velocity element and all noise nodes.

#include <span>
#include <vector>

#include "stickslip/noise/nodes.hpp"
#include "stickslip/petsc/dense.hpp"
#include "stickslip/velocity/hp_axis.hpp"

namespace stickslip::operators {

/// The rows of lambda - L on the element [a, b] of a half line, cut off from its neighbours: what
/// it takes from them are the values beyond b on nodes with B(b) > 0 and beyond a on those with
/// B(a) <= 0; what it gives are its values at a on nodes with B(a) > 0 and at b on those with
/// B(b) <= 0. Speeds B rise with the noise, so that each of these sets is a range of nodes.
///
/// Along the noise the system is block tridiagonal over groups, its couplings of the rank of the
/// element's nodes: jumps reach the next group through its first or last level alone. LU factors by
/// groups. Indices run by noise nodes 0 ... M-1, then by the q nodes of the element. Local.
class ElementSystem {
 public:
  using Scalars = petsc::Scalars;

  /// For the speeds x_l + g - mu_d + b(v), `excess` being x_l + g - mu_d by node. Refers to nodes
  /// and axis. O(M q^3 groups' sizes^2). Throws NotReached if a block is singular.
  ElementSystem(const noise::Nodes& noise, const velocity::HpAxis& axis, int element,
                std::span<const double> excess, PetscScalar lambda);

  [[nodiscard]] int size() const { return count_ * nodes_; }
  [[nodiscard]] int nodes() const { return nodes_; }       ///< q
  [[nodiscard]] int first_node() const { return first_; }  ///< on the axis
  /// First noise node with B(a) > 0, and with B(b) > 0.
  [[nodiscard]] int rising_at_inner() const { return rising_inner_; }
  [[nodiscard]] int rising_at_outer() const { return rising_outer_; }

  /// What values beyond the ends make of those given: by outward and inward sides,
  ///
  ///   (values at a) = inner_inner (beyond a) + inner_outer (beyond b),
  ///   (values at b) = outer_inner (beyond a) + outer_outer (beyond b).
  struct Response {
    petsc::DenseMatrix inner_inner, inner_outer, outer_inner, outer_outer;
  };
  /// O(M^2 q).
  [[nodiscard]] Response response() const;

  /// x <- A^-1 x, or A^-T x.
  void solve(Scalars& x, bool transposed) const;

  /// f += what the values beyond a and b send in: full lists by noise node, of which the ranges
  /// above are read. Transposed: fluxes by noise node of what a solution sends out, into `inner`
  /// and `outer`.
  void lift(const Scalars& inner, const Scalars& outer, Scalars& f) const;
  void lift_transposed(const Scalars& x, Scalars& inner, Scalars& outer) const;
  /// Values at a and b of a solution, and the transposed.
  void trace(const Scalars& u, Scalars& inner, Scalars& outer) const;
  void trace_transposed(const Scalars& inner, const Scalars& outer, Scalars& b) const;

  /// Of the factors.
  [[nodiscard]] double entries() const;

 private:
  // Rates of the own nodes among each other: by noise node, q x q by rows, zero diagonals.
  using Rows = std::vector<double>;
  struct Group {
    const noise::Nodes::Group* noise;
    int begin, count;  // noise nodes from 0
    petsc::DenseFactors factors;
    petsc::DenseMatrix to_next;    // D^-1 (a x 1): what values on the next group make here
    petsc::DenseMatrix to_before;  // D^-1 (b x 1): the same for the group before
  };
  class Sweep;

  [[nodiscard]] Rows rows_of(const velocity::HpAxis& axis, std::span<const double> excess);
  [[nodiscard]] petsc::DenseMatrix block(const noise::Nodes& noise, const Rows& rows,
                                         const Group& group, PetscScalar lambda) const;
  [[nodiscard]] petsc::DenseMatrix spread(std::span<const double> rates) const;
  void eliminate(const noise::Nodes& noise, const Rows& rows, PetscScalar lambda);
  void solve_plain(Scalars& x) const;
  void solve_transposed(Scalars& x) const;

  int count_, nodes_ = 0, first_ = 0;
  int rising_inner_ = 0, rising_outer_ = 0;
  std::vector<double> at_inner_, at_outer_;      // l_n(a), l_n(b)
  std::vector<double> from_inner_, from_outer_;  // by noise node and node: rates to beyond the ends
  std::vector<Group> groups_;
};

}  // namespace stickslip::operators
