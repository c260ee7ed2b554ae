#pragma once
/// What polynomials of higher degree add to those of lower degree, for discontinuous Galerkin
/// transport on a chain of levels.

#include <petscmat.h>

#include <array>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/neighbours.hpp"
#include "stickslip/petsc/split_matrix.hpp"

namespace stickslip::petsc {

/// Polynomials on an element with q nodes as those of lower degree, by their values at c nodes, and
/// q - c high modes; matrices by columns. (prolong, from_high) and (restrict; to_high) are inverse
/// to each other.
struct ElementModes {
  int nodes = 0, coarse_nodes = 0;       ///< q, c
  std::vector<PetscScalar> prolong;      ///< q x c
  std::vector<PetscScalar> restriction;  ///< c x q
  std::vector<PetscScalar> from_high;    ///< q x (q - c)
  std::vector<PetscScalar> to_high;      ///< (q - c) x q
  [[nodiscard]] int high() const { return nodes - coarse_nodes; }
};

/// One element on all local levels: the values of its nodes lie one after the other by level, node
/// by node, in the fine vector and in the coarse one.
struct Strip {
  std::shared_ptr<const ElementModes> modes;
  PetscInt first = 0, coarse_first = 0;  ///< local rows of the first node on the first level
};

/// How a fine discretisation contains a coarse one. Levels -N ... N form a chain; this rank owns
/// shells {i, -i} of them, the first rank the innermost.
struct Hierarchy {
  int levels = 0;       ///< local ones, rising
  int below = 0;        ///< those of them below level 0
  bool centre = false;  ///< whether level 0 is here
  std::vector<Strip> strips;
  std::vector<std::pair<PetscInt, PetscInt>> others;  ///< fine and coarse rows of other states
};

/// c = P' b, or R b for a plain system. Local.
void restrict_to_coarse(const Hierarchy& hierarchy, Vec b, Vec c, bool transposed);
/// x = R' c, or P c for a plain system. Local.
void prolong(const Hierarchy& hierarchy, Vec c, Vec x, bool transposed);

/// The high modes of each element, coupled over all levels but not from element to element, and the
/// coarse part of vectors:
///
///   x += H (S + J)^-1 H' r,
///
/// H, H' and, for the coarse part, P, R being the changes of basis of ElementModes, J the jumps
/// between levels, and S the Schur complement of the lower modes in the transport T on one element,
///
///   S = T_hh - T_hc (T_cc + e)^-1 T_ch,   e = 1e-6 of the rate of jumps.
///
/// For transport at constant speed S is that of the whole axis, as inflow at the end of an element
/// makes a constant there, which has no high modes; T_hh alone would be half of it. After an exact
/// solution of the coarse problem this leaves a fifth to a half of the error, whatever the levels,
/// degrees and noise.
class HighModes {
 public:
  /// Of a SplitMatrix, kept by reference count, whose strips are those of the hierarchy, over
  /// `coarse`, of which only the layout counts. Collective.
  HighModes(Mat matrix, Mat coarse, Hierarchy hierarchy);

  /// Reads the matrix and eliminates. Collective. Throws NotReached if a block is singular,
  /// NoMemory.
  void factor();

  /// x += H (S + J)^-1 H' r. Collective.
  void add(Vec r, Vec x, bool transposed) const;

  /// What solves A_c x = b, or A_c^T x = b.
  using CoarseSolve = std::function<void(Vec b, Vec x, bool transposed)>;
  /// x = P A_c^-1 R b, then x += H (S + J)^-1 H' (b - A x). Collective.
  void cycle(const CoarseSolve& solve, Vec b, Vec x, bool transposed) const;

  /// Entries and operations of this rank.
  [[nodiscard]] double entries() const;
  [[nodiscard]] double operations() const;

 private:
  using Scalars = std::vector<PetscScalar>;
  // Levels below 0 or above it, from the outermost local one inwards.
  struct Arm {
    int number, begin, end, step;
    // Rates at which a level is left for the one outside or inside of it, and reached from it.
    const std::vector<double>&to_outer, &from_outer, &to_inner, &from_inner;
  };
  [[nodiscard]] std::array<Arm, 2> arms() const;

  void reserve();
  // Whether no block was singular.
  [[nodiscard]] bool complement(std::size_t n);
  [[nodiscard]] bool eliminate(std::size_t n);
  void add(const PetscScalar* r, PetscScalar* x, bool transposed) const;
  void pass_inwards(std::size_t n, bool transposed) const;
  void pass_outwards(std::size_t n, bool transposed) const;

  MatHandle matrix_;
  const SplitMatrix& parts_;
  VecHandle coarse_b_, coarse_x_, residual_;
  Hierarchy hierarchy_;
  MPI_Comm comm_;
  Neighbours ranks_;
  std::vector<Scalars> pivots_;        // by strip, those of its levels inverted
  mutable std::vector<Scalars> high_;  // by strip, the high modes in work
};

}  // namespace stickslip::petsc
