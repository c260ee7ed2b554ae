#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "stickslip/petsc/dense.hpp"
#include "stickslip/petsc/dense_inverse.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using petsc::DenseInverse;
using petsc::Triangle;

namespace {

// Block upper triangular with respect to the cuts, the diagonal larger than the rest.
std::vector<PetscScalar> some_matrix(const Triangle& triangle) {
  const auto& [cuts, reach] = triangle;
  const int n = cuts.back();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> entry(-1, 1);
  std::vector<PetscScalar> a(static_cast<std::size_t>(n) * n, 0.0);
  for (int b = 0; b < triangle.blocks(); ++b) {
    for (int c = cuts[b]; c < reach[b]; ++c) {
      for (int r = cuts[b]; r < cuts[b + 1]; ++r) a[r + c * n] = entry(random) + (r == c ? 12 : 0);
    }
  }
  return a;
}

// Largest entry of A B - 1.
double distance_from_unit(const std::vector<PetscScalar>& a, const std::vector<PetscScalar>& b,
                          int n) {
  double largest = 0;
  for (int c = 0; c < n; ++c) {
    for (int r = 0; r < n; ++r) {
      PetscScalar sum = r == c ? -1 : 0;
      for (int k = 0; k < n; ++k) sum += a[r + k * n] * b[k + c * n];
      largest = std::max(largest, static_cast<double>(PetscAbsScalar(sum)));
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("dense inverse: full and block triangular, smaller and larger than a last block") {
  for (const Triangle& triangle :
       {Triangle{{0, 1}, {1}}, Triangle{{0, 16}, {16}}, Triangle{{0, 17}, {17}},
        Triangle{{0, 97}, {97}}, Triangle{{0, 1, 2, 3}, {3, 3, 3}},
        Triangle{{0, 5, 40, 90}, {90, 90, 90}},
        Triangle{{0, 50, 53, 60, 61, 90}, {90, 90, 90, 90, 90}},
        Triangle{{0, 20, 50, 70, 90}, {50, 50, 90, 90}},
        Triangle{{0, 20, 50, 70, 90}, {70, 70, 70, 90}}, Triangle{{0, 20, 50, 70}, {20, 50, 70}}}) {
    const auto a = some_matrix(triangle);
    auto inverse = a;
    DenseInverse()(inverse.data(), triangle);
    const auto& [cuts, reach] = triangle;
    const int n = cuts.back();
    INFO("n = " << n << ", " << triangle.blocks() << " blocks, first reach " << reach[0]);
    CHECK(distance_from_unit(a, inverse, n) < 1e-12);
    for (int b = 0; b < triangle.blocks(); ++b) {
      for (int r = cuts[b]; r < cuts[b + 1]; ++r) {
        for (int c = 0; c < n; ++c) {
          if (c < cuts[b] || c >= reach[b]) CHECK(inverse[r + c * n] == PetscScalar(0));
        }
      }
    }
  }
}

TEST_CASE("dense inverse: small blocks of larger matrices, with exchanges of rows") {
  for (int n = 1; n <= 16; ++n) {
    const int stride = n + 3;
    const auto size = static_cast<std::size_t>(stride) * n;
    std::mt19937 random(n);
    std::normal_distribution<double> entry;
    std::vector<PetscScalar> whole(size);
    for (auto& value : whole) value = entry(random);
    if (n > 1) whole[0] = 0;
    auto result = whole;
    std::vector<int> exchanges(n);
    REQUIRE(petsc::invert(result.data(), n, stride, exchanges));
    std::vector<PetscScalar> a, inverse;
    for (int c = 0; c < n; ++c) {
      for (int r = 0; r < stride; ++r) {
        const int at = r + stride * c;
        if (r >= n) CHECK(result[at] == whole[at]);
        if (r < n) a.push_back(whole[at]);
        if (r < n) inverse.push_back(result[at]);
      }
    }
    CHECK(distance_from_unit(a, inverse, n) < 1e-12);
    CHECK(distance_from_unit(inverse, a, n) < 1e-12);
  }
}

TEST_CASE("dense inverse: rows are exchanged in last blocks") {
  std::vector<PetscScalar> swap{0, 1, 1, 0};
  DenseInverse()(swap.data(), {{0, 2}, {2}});
  CHECK(swap == std::vector<PetscScalar>{0, 1, 1, 0});
}

TEST_CASE("dense inverse: a singular block is refused") {
  std::vector<PetscScalar> ones(9, 1.0);
  CHECK_THROWS_AS(DenseInverse()(ones.data(), {{0, 3}, {3}}), NotReached);
}

TEST_CASE("dense inverse: triangles need a sixth of the operations, two of them a 24th") {
  const double full = DenseInverse::operations({{0, 512}, {512}});
  CHECK(full == Approx(2.0 * 512 * 512 * 512));
  Triangle one, two;
  for (int c = 2; c <= 512; c += 2) {
    one.cuts.push_back(c);
    one.reach.push_back(512);
    two.reach.push_back(c <= 256 ? 256 : 512);
  }
  two.cuts = one.cuts;
  CHECK(DenseInverse::operations(one) / full == Approx(1.0 / 6).epsilon(0.02));
  CHECK(DenseInverse::operations(two) / full == Approx(1.0 / 24).epsilon(0.03));
  CHECK(one.entries() == 512 * 513 / 2 + 256);
}
