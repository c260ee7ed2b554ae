#pragma once
/// How far a solution is from being exact for entries slightly off.

#include <petscmat.h>

#include "stickslip/petsc/handle.hpp"

namespace stickslip::petsc {

/// Backward errors of solutions with one matrix.
///
/// Its rows differ by many orders of magnitude, so that norms of the whole matrix would hide a bad
/// row; |A| |x| does not. A forward solution is of one size: the largest component counts (Oettli
/// and Prager). A transposed one is an occupation, time spent in each state: |A|^T |x| counts
/// visits, falls off by tens of orders of magnitude, and its sum is what functionals see.
class BackwardError {
 public:
  /// The matrix must outlive this object, and keep its values.
  explicit BackwardError(Mat matrix) : matrix_(matrix) {}

  /// max_i |r|_i / (|A| |x| + |b|)_i with r = b - A x, which is overwritten; to |x| is added 1e-13
  /// of its largest component. Collective.
  [[nodiscard]] double forward(Vec residual, Vec b, Vec x);
  /// sum_i |r|_i / sum_i (|A|^T |x| + |b|)_i with r = b - A^T x. Collective.
  [[nodiscard]] double transposed(Vec residual, Vec b, Vec x);

 private:
  Mat matrix_;
  // |a_ij| and the sums of its rows, when first needed.
  MatHandle magnitude_;
  VecHandle magnitude_sums_;
};

}  // namespace stickslip::petsc
