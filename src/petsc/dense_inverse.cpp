#include "stickslip/petsc/dense_inverse.hpp"

#include <petscsys.h>
// After PETSc itself, whose types it uses.
#include <petscblaslapack.h>

#include <algorithm>
#include <array>

#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr int kLeaf = 16;

// The cut nearest to the middle of the range; cuts.size() > 2.
std::size_t middle(std::span<const int> cuts) {
  const int centre = (cuts.front() + cuts.back()) / 2;
  std::size_t best = 1;
  for (std::size_t c = 2; c + 1 < cuts.size(); ++c) {
    if (std::abs(cuts[c] - centre) < std::abs(cuts[best] - centre)) best = c;
  }
  return best;
}

double block_operations(double n) { return 2 * n * n * n; }

}  // namespace

// Work space of all levels of the recursion: n^2/2 for the first, a quarter of it for the next.
void DenseInverse::operator()(PetscScalar* a, std::span<const int> cuts) {
  const int n = cuts.back();
  const auto needed = static_cast<std::size_t>(n) * n;
  if (space_.size() < needed) space_.resize(needed);
  used_ = 0;
  invert_triangle({a, n, n, n}, cuts);
}

// (A B; 0 C)^-1 = (A^-1 -A^-1 B C^-1; 0 C^-1).
void DenseInverse::invert_triangle(const Block& a, std::span<const int> cuts) {
  if (cuts.size() == 2) {
    invert_block(a);
    return;
  }
  const std::size_t cut = middle(cuts);
  const int begin = cuts.front(), upper = cuts[cut] - begin, lower = cuts.back() - cuts[cut];
  const auto above = cuts.subspan(0, cut + 1), below = cuts.subspan(cut);
  const Block first = a.part(0, 0, upper, upper), last = a.part(upper, upper, lower, lower),
              corner = a.part(0, upper, upper, lower);
  invert_triangle(first, above);
  invert_triangle(last, below);
  const std::size_t before = used_;
  const Block product = take(upper, lower);
  for (std::size_t b = 0; b + 1 < above.size(); ++b) {
    const int row = above[b] - begin, rows = above[b + 1] - above[b];
    multiply(1, first.part(row, row, rows, upper - row), corner.part(row, 0, upper - row, lower), 0,
             product.part(row, 0, rows, lower));
  }
  for (std::size_t b = 0; b + 1 < below.size(); ++b) {
    const int column = below[b] - below[0], columns = below[b + 1] - below[b];
    multiply(-1, product.part(0, 0, upper, column + columns),
             last.part(0, column, column + columns, columns), 0,
             corner.part(0, column, upper, columns));
  }
  used_ = before;
}

// With S = D - C A^-1 B: (A B; C D)^-1 = (A^-1 + A^-1 B S^-1 C A^-1, -A^-1 B S^-1; -S^-1 C A^-1,
// S^-1).
void DenseInverse::invert_block(const Block& a) {
  const int n = a.rows;
  if (n <= kLeaf) {
    invert_leaf(a);
    return;
  }
  const int upper = n / 2, lower = n - upper;
  const Block first = a.part(0, 0, upper, upper), last = a.part(upper, upper, lower, lower),
              right = a.part(0, upper, upper, lower), left = a.part(upper, 0, lower, upper);
  const std::size_t before = used_;
  invert_block(first);
  const Block to_right = take(upper, lower), to_left = take(lower, upper);
  multiply(1, first, right, 0, to_right);
  multiply(1, left, first, 0, to_left);
  multiply(-1, left, to_right, 1, last);
  invert_block(last);
  multiply(-1, to_right, last, 0, right);
  multiply(-1, last, to_left, 0, left);
  multiply(-1, right, to_left, 1, first);
  used_ = before;
}

void DenseInverse::invert_leaf(const Block& a) {
  PetscBLASInt n = a.rows, stride = a.stride, info = 0;
  std::array<PetscBLASInt, kLeaf> pivots{};
  constexpr PetscBLASInt size = kLeaf * kLeaf;
  work_.resize(size);
  LAPACKgetrf_(&n, &n, a.data, &stride, pivots.data(), &info);
  if (info == 0) LAPACKgetri_(&n, a.data, &stride, pivots.data(), work_.data(), &size, &info);
  if (info != 0) throw NotReached("a block is singular");
}

DenseInverse::Block DenseInverse::take(int rows, int columns) {
  const Block block{space_.data() + used_, rows, columns, rows};
  used_ += static_cast<std::size_t>(rows) * columns;
  return block;
}

// c <- factor a b + keep c.
void DenseInverse::multiply(double factor, const Block& a, const Block& b, double keep,
                            const Block& c) {
  const PetscBLASInt m = c.rows, n = c.columns, k = a.columns;
  const PetscBLASInt lda = a.stride, ldb = b.stride, ldc = c.stride;
  const PetscScalar alpha = factor, beta = keep;
  BLASgemm_("N", "N", &m, &n, &k, &alpha, a.data, &lda, b.data, &ldb, &beta, c.data, &ldc);
}

double DenseInverse::operations(std::span<const int> cuts) {
  if (cuts.size() == 2) return block_operations(cuts[1] - cuts[0]);
  const std::size_t cut = middle(cuts);
  const auto above = cuts.subspan(0, cut + 1), below = cuts.subspan(cut);
  const double upper = above.back() - above.front(), lower = below.back() - below.front();
  double sum = operations(above) + operations(below);
  for (std::size_t b = 0; b + 1 < above.size(); ++b) {
    sum += 2.0 * (above[b + 1] - above[b]) * (above.back() - above[b]) * lower;
  }
  for (std::size_t b = 0; b + 1 < below.size(); ++b) {
    sum += 2.0 * (below[b + 1] - below[b]) * (below[b + 1] - below[0]) * upper;
  }
  return sum;
}

}  // namespace stickslip::petsc
