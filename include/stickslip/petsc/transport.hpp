#pragma once
/// Discontinuous Galerkin transport on a chain of levels, element by element.

#include <petscsys.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace stickslip::petsc {

/// Polynomials on an element by their values at q nodes, in the order of rows, for a length of 1.
struct TransportElement {
  int nodes = 0;                     ///< q
  std::vector<PetscScalar> rows;     ///< (q+2) x q: D; u(b) and u(a) as combinations of values
  std::vector<PetscScalar> lifting;  ///< q x 2: l_m(b)/w_m, l_m(a)/w_m

  /// Rows of the matrix `rows`.
  [[nodiscard]] int height() const { return nodes + 2; }
};

/// The element [a, b], a nearer to v = 0, on all local levels, whose values lie one after the other
/// by level, node by node.
struct TransportStrip {
  std::shared_ptr<const TransportElement> element;
  PetscInt first = 0;  ///< local row of the first node on the first level
  double length = 0;
  std::vector<double> drag;                           ///< at the nodes
  double drag_at_inner = 0, drag_at_outer = 0;        ///< at a and b
  int inner = -1, outer = -1;                         ///< strips beyond a and b, -1 for none
  std::shared_ptr<const std::vector<double>> excess;  ///< by local level
};

/// T, the transport of HpAxis, on all levels of a rank:
///
///   (T u)_m = B(v_m) u'(v_m) + B(b)^+ l_m(b)/w_m (u(b+) - u(b-))
///                            + B(a)^- l_m(a)/w_m (u(a-) - u(a+)),
///
/// B = excess + drag, with 0 for u beyond the ends of the axis. Nothing is stored but one element
/// of each degree; a product takes 2 q operations for each value. Nothing here is collective.
class Transport {
 public:
  /// `levels`: local ones. A rank has all strips, each on its own levels.
  Transport(int levels, std::vector<TransportStrip> strips);

  /// y -= T x, or T^T x.
  void subtract(const PetscScalar* x, PetscScalar* y, bool transposed) const;

  /// The same with the size of every term of a sum in the place of the term and a plus for a minus:
  /// a bound of |T|, by which `subtract` becomes y += |T| x.
  [[nodiscard]] Transport sizes() const;

  /// T on the nodes of strip n and level l as sum of matrices, q x q by columns:
  ///
  ///   excess by_excess + constant + up by_up + down by_down,
  ///
  /// with the speeds below.
  struct Terms {
    std::vector<PetscScalar> by_excess, constant, by_up, by_down;
  };
  [[nodiscard]] Terms terms(std::size_t n) const;
  struct Speeds {
    double excess, up, down;  ///< up and down: of leaving the element, B(b)^+ and B(a)^-
  };
  [[nodiscard]] Speeds speeds(std::size_t n, int level) const {
    const TransportStrip& s = strips_[n];
    const double excess = (*s.excess)[level];
    return {excess, std::max(excess + s.drag_at_outer, 0.0),
            std::max(-(excess + s.drag_at_inner), 0.0)};
  }

  /// Entries of T that an assembly would store.
  [[nodiscard]] PetscInt64 entries() const;

 private:
  void subtract_plain(const PetscScalar* x, PetscScalar* y) const;
  void subtract_transposed(const PetscScalar* x, PetscScalar* y) const;
  // What is kept for both ends of a strip while in work: by end (outer, inner), then by level.
  [[nodiscard]] PetscScalar* ends(int strip) const {
    return ends_.data() + 2 * static_cast<std::ptrdiff_t>(levels_) * strip;
  }
  // B over the length of the strip, by level.
  const double* speed_at(const TransportStrip& s, int node) const;

  int levels_;
  std::vector<TransportStrip> strips_;
  bool sizes_ = false;
  mutable std::vector<PetscScalar> ends_, work_;
  mutable std::vector<double> speed_;
};

}  // namespace stickslip::petsc
