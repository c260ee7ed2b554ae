#pragma once
/// Preconditioners of our own, which PETSc calls as those of type "shell".

#include <petscvec.h>

namespace stickslip::petsc {

/// An approximate, or exact, inverse of a matrix.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  Preconditioner(const Preconditioner&) = delete;
  Preconditioner& operator=(const Preconditioner&) = delete;

  /// Prepares, for the matrix with `shift` times the identity added since this object was made, as
  /// its values say already. Collective. Throws NotReached where the matrix is singular, NoMemory
  /// when the factors do not fit.
  virtual void factor(PetscScalar shift) = 0;
  /// x = M^-1 b, or M^-T b without conjugation. Collective.
  virtual void apply(Vec b, Vec x, bool transposed) const = 0;

  /// Of all ranks: entries of the factors, bytes while factoring, operations of factoring.
  [[nodiscard]] double entries() const { return entries_; }
  [[nodiscard]] double bytes() const { return bytes_; }
  [[nodiscard]] double operations() const { return operations_; }

 protected:
  Preconditioner() = default;
  // The same of all ranks, when the analysis knows.
  void set_cost(double entries, double bytes, double operations) {
    entries_ = entries;
    bytes_ = bytes;
    operations_ = operations;
  }

 private:
  double entries_ = 0, bytes_ = 0, operations_ = 0;
};

}  // namespace stickslip::petsc
