#pragma once
/// Inverses of dense matrices that are block upper triangular.

#include <petscsys.h>

#include <cstddef>
#include <span>
#include <vector>

namespace stickslip::petsc {

/// Inverts in place, by halves, so that nearly all arithmetic is products of matrices: LAPACK
/// inverts matrices of a few hundred rows at a third of their speed. Rows are exchanged within the
/// last blocks of some 16 rows only; what that costs in accuracy is for the caller to look at.
class DenseInverse {
 public:
  /// `a`: n x n, by columns, zero below the blocks that `cuts` (0 ... n, rising) make of the
  /// diagonal; n is cuts.back(). 2 n^3 operations for one block, a sixth of that for many. Throws
  /// NotReached if a block is singular.
  void operator()(PetscScalar* a, std::span<const int> cuts);

  /// Floating point operations that it takes.
  [[nodiscard]] static double operations(std::span<const int> cuts);

 private:
  // A block of a larger matrix, by columns.
  struct Block {
    PetscScalar* data;
    int rows, columns, stride;
    [[nodiscard]] Block part(int row, int column, int some_rows, int some_columns) const {
      return {data + row + static_cast<std::ptrdiff_t>(column) * stride, some_rows, some_columns,
              stride};
    }
  };
  void invert_triangle(const Block& a, std::span<const int> cuts);
  void invert_block(const Block& a);
  void invert_leaf(const Block& a);
  [[nodiscard]] Block take(int rows, int columns);
  static void multiply(double factor, const Block& a, const Block& b, double keep, const Block& c);

  std::vector<PetscScalar> space_;
  std::size_t used_ = 0;
  std::vector<PetscScalar> work_;  // of LAPACK
};

}  // namespace stickslip::petsc
