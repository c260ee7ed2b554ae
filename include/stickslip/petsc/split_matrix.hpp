#pragma once
/// A matrix of which transport and jumps are applied, not stored.

#include <petscmat.h>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/jumps.hpp"
#include "stickslip/petsc/transport.hpp"

namespace stickslip::petsc {

/// A = S + J - T with jumps J between levels, a transport T within each level, and a sparse S: what
/// happens at the ends of the axis, and where jumps lead to levels of other ranks. A Mat of type
/// "shell" that can be multiplied with, plain and transposed.
class SplitMatrix {
 public:
  /// The Mat owns all. J and T act on the local rows of S. Collective.
  [[nodiscard]] static MatHandle make(MatHandle sparse, Jumps jumps, Transport transport);
  /// What a Mat is made of; null if it is no such one. Local.
  [[nodiscard]] static const SplitMatrix* of(Mat matrix);

  [[nodiscard]] Mat sparse() const { return sparse_; }
  [[nodiscard]] const Jumps& jumps() const { return jumps_; }
  [[nodiscard]] const Transport& transport() const { return transport_; }

  /// y = A x, or A^T x. Collective.
  void multiply(Vec x, Vec y, bool transposed) const;

 private:
  SplitMatrix(MatHandle sparse, Jumps jumps, Transport transport)
      : sparse_(std::move(sparse)), jumps_(std::move(jumps)), transport_(std::move(transport)) {}

  MatHandle sparse_;
  Jumps jumps_;
  Transport transport_;
};

/// |A|, entry by entry; of a split matrix a bound, |S| + |J| + |T| with the sizes of all terms of
/// T. Collective.
[[nodiscard]] MatHandle magnitudes(Mat matrix);
/// The sums of its rows. Collective.
[[nodiscard]] VecHandle magnitude_sums(Mat matrix);

}  // namespace stickslip::petsc
