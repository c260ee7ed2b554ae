#pragma once
/// Inverses of dense matrices that are block upper triangular.

#include <petscsys.h>

#include <cstddef>
#include <vector>

namespace stickslip::petsc {

/// Where a block upper triangular matrix, and its inverse, is not zero: block b has the rows
/// cuts[b] ... cuts[b + 1] - 1 and the columns cuts[b] ... reach[b] - 1. Reaches are ends of
/// blocks, and no block reaches less far than those whose columns it has.
struct Triangle {
  std::vector<int> cuts{0}, reach;

  [[nodiscard]] int blocks() const { return static_cast<int>(reach.size()); }
  [[nodiscard]] int rows(int block) const { return cuts[block + 1] - cuts[block]; }
  [[nodiscard]] int columns(int block) const { return reach[block] - cuts[block]; }
  [[nodiscard]] std::size_t entries() const;
};

/// Inverts in place, by halves, so that nearly all arithmetic is products of matrices: LAPACK
/// inverts matrices of a few hundred rows at a third of their speed. Rows are exchanged within the
/// last blocks of some 16 rows only; what that costs in accuracy is for the caller to look at.
class DenseInverse {
 public:
  /// `a`: n x n, by columns, with n = cuts.back(). 2 n^3 operations for one block, a sixth of that
  /// for many. Throws NotReached if a block is singular.
  void operator()(PetscScalar* a, const Triangle& triangle);

  /// Work space for matrices of up to n rows, so that none is allocated later.
  void reserve(int n);

  /// Floating point operations that it takes.
  [[nodiscard]] static double operations(const Triangle& triangle);

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
  // Blocks [first, last) of a triangle.
  struct Part {
    const Triangle& whole;
    int first, last;
    [[nodiscard]] int begin() const { return whole.cuts[first]; }
    [[nodiscard]] int end() const { return whole.cuts[last]; }
    [[nodiscard]] int reach() const;
    [[nodiscard]] int middle() const;
  };
  void invert_triangle(const Block& a, const Part& part);
  static double operations(const Part& part);
  void invert_block(const Block& a);
  void invert_leaf(const Block& a);
  [[nodiscard]] Block take(int rows, int columns);
  static void multiply(double factor, const Block& a, const Block& b, double keep, const Block& c);

  std::vector<PetscScalar> space_;
  std::size_t used_ = 0;
};

}  // namespace stickslip::petsc
