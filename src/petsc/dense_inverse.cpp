#include "stickslip/petsc/dense_inverse.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "stickslip/petsc/dense.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::petsc {
namespace {

constexpr int kLeaf = 16;

double block_operations(double n) { return 2 * n * n * n; }

}  // namespace

std::size_t Triangle::entries() const {
  std::size_t sum = 0;
  for (int b = 0; b < blocks(); ++b) sum += static_cast<std::size_t>(rows(b)) * columns(b);
  return sum;
}

int DenseInverse::Part::reach() const {
  return *std::max_element(whole.reach.begin() + first, whole.reach.begin() + last);
}

// The block whose beginning is nearest to the middle of the rows; first + 1 < last.
int DenseInverse::Part::middle() const {
  const int centre = (begin() + end()) / 2;
  int best = first + 1;
  for (int b = first + 2; b < last; ++b) {
    if (std::abs(whole.cuts[b] - centre) < std::abs(whole.cuts[best] - centre)) best = b;
  }
  return best;
}

// For all levels of the recursion: n^2/2 for the first, a quarter of it for the next.
void DenseInverse::reserve(int n) {
  const auto needed = static_cast<std::size_t>(n) * n;
  if (space_.size() < needed) space_.resize(needed);
}

void DenseInverse::operator()(PetscScalar* a, const Triangle& triangle) {
  const int n = triangle.cuts.back();
  reserve(n);
  used_ = 0;
  invert_triangle({a, n, n, n}, {triangle, 0, triangle.blocks()});
}

// (A B; 0 C)^-1 = (A^-1 -A^-1 B C^-1; 0 C^-1).
void DenseInverse::invert_triangle(const Block& a, const Part& part) {
  if (part.first + 1 == part.last) {
    invert_block(a);
    return;
  }
  const auto& [cuts, reach] = part.whole;
  const Part above{part.whole, part.first, part.middle()}, below{part.whole, above.last, part.last};
  const int begin = above.begin(), centre = below.begin();
  const int end = std::min(above.reach(), part.end());
  const int upper = centre - begin, lower = below.end() - centre, width = end - centre;
  const Block first = a.part(0, 0, upper, upper), last = a.part(upper, upper, lower, lower);
  invert_triangle(first, above);
  invert_triangle(last, below);
  if (width <= 0) return;
  const Block corner = a.part(0, upper, upper, width);
  const std::size_t before = used_;
  const Block product = take(upper, width);
  for (int b = above.first; b < above.last; ++b) {
    const int row = cuts[b] - begin, rows = part.whole.rows(b);
    const int inner = std::min(reach[b], centre) - cuts[b];
    multiply(1, first.part(row, row, rows, inner), corner.part(row, 0, inner, width), 0,
             product.part(row, 0, rows, width));
  }
  for (int b = below.first; b < below.last && cuts[b] < end; ++b) {
    const int column = cuts[b] - centre, columns = part.whole.rows(b);
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
  std::array<int, kLeaf> exchanges{};
  if (invert(a.data, a.rows, a.stride, exchanges)) return;
  throw NotReached("a block of the elimination is singular; -slide_pc_type lu exchanges more rows");
}

DenseInverse::Block DenseInverse::take(int rows, int columns) {
  const Block block{space_.data() + used_, rows, columns, rows};
  used_ += static_cast<std::size_t>(rows) * columns;
  return block;
}

// c <- factor a b + keep c.
void DenseInverse::multiply(double factor, const Block& a, const Block& b, double keep,
                            const Block& c) {
  petsc::product("NN", c.rows, c.columns, a.columns, factor, a.data, a.stride, b.data, b.stride,
                 keep, c.data, c.stride);
}

double DenseInverse::operations(const Triangle& triangle) {
  return operations(Part{triangle, 0, triangle.blocks()});
}

double DenseInverse::operations(const Part& part) {
  if (part.first + 1 == part.last) return block_operations(part.end() - part.begin());
  const auto& [cuts, reach] = part.whole;
  const Part above{part.whole, part.first, part.middle()}, below{part.whole, above.last, part.last};
  const int centre = below.begin(), end = std::min(above.reach(), part.end());
  double sum = operations(above) + operations(below);
  for (int b = above.first; b < above.last; ++b) {
    const double inner = std::min(reach[b], centre) - cuts[b];
    sum += 2.0 * part.whole.rows(b) * inner * std::max(end - centre, 0);
  }
  for (int b = below.first; b < below.last && cuts[b] < end; ++b) {
    sum += 2.0 * part.whole.rows(b) * (cuts[b + 1] - centre) * (centre - above.begin());
  }
  return sum;
}

}  // namespace stickslip::petsc
