#pragma once
/// A matrix of which the transport within levels is applied, not stored.

#include <petscmat.h>

#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/transport.hpp"

namespace stickslip::petsc {

/// A = S - T with a sparse S, the jumps between levels and what happens at the ends of the axis,
/// and a transport T within each level, as a Mat of type "shell" that can be multiplied with, plain
/// and transposed: a sixth of the memory of an assembled one, and half of its time.
class SplitMatrix {
 public:
  /// The Mat owns both. T acts on the local rows of S. Collective.
  [[nodiscard]] static MatHandle make(MatHandle sparse, Transport transport);
  /// What a Mat is made of; null if it is no such one. Local.
  [[nodiscard]] static const SplitMatrix* of(Mat matrix);

  [[nodiscard]] Mat sparse() const { return sparse_; }
  [[nodiscard]] const Transport& transport() const { return transport_; }

  /// y = A x, or A^T x. Collective.
  void multiply(Vec x, Vec y, bool transposed) const;

 private:
  SplitMatrix(MatHandle sparse, Transport transport)
      : sparse_(std::move(sparse)), transport_(std::move(transport)) {}

  MatHandle sparse_;
  Transport transport_;
};

/// |A|, entry by entry; of a split matrix a bound, |S| + |T| with the sizes of all terms of T.
/// Collective.
[[nodiscard]] MatHandle magnitudes(Mat matrix);
/// The sums of its rows. Collective.
[[nodiscard]] VecHandle magnitude_sums(Mat matrix);

}  // namespace stickslip::petsc
