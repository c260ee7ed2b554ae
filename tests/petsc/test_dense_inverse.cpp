#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "stickslip/petsc/dense_inverse.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using petsc::DenseInverse;

namespace {

// Block upper triangular with respect to the cuts, the diagonal larger than the rest.
std::vector<PetscScalar> some_matrix(const std::vector<int>& cuts) {
  const int n = cuts.back();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> entry(-1, 1);
  std::vector<PetscScalar> a(static_cast<std::size_t>(n) * n, 0.0);
  for (std::size_t b = 0; b + 1 < cuts.size(); ++b) {
    for (int c = cuts[b]; c < n; ++c) {
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
  for (const std::vector<int>& cuts : {std::vector{0, 1},
                                       {0, 16},
                                       {0, 17},
                                       {0, 97},
                                       {0, 1, 2, 3},
                                       {0, 5, 40, 90},
                                       {0, 50, 53, 60, 61, 90}}) {
    const auto a = some_matrix(cuts);
    auto inverse = a;
    DenseInverse()(inverse.data(), cuts);
    const int n = cuts.back();
    INFO("n = " << n << ", " << cuts.size() - 1 << " blocks");
    CHECK(distance_from_unit(a, inverse, n) < 1e-12);
    for (std::size_t b = 0; b + 1 < cuts.size(); ++b) {
      for (int r = cuts[b]; r < cuts[b + 1]; ++r) {
        for (int c = 0; c < cuts[b]; ++c) CHECK(inverse[r + c * n] == PetscScalar(0));
      }
    }
  }
}

TEST_CASE("dense inverse: rows are exchanged in last blocks") {
  std::vector<PetscScalar> swap{0, 1, 1, 0};
  DenseInverse()(swap.data(), std::vector{0, 2});
  CHECK(swap == std::vector<PetscScalar>{0, 1, 1, 0});
}

TEST_CASE("dense inverse: a singular block is refused") {
  std::vector<PetscScalar> ones(9, 1.0);
  CHECK_THROWS_AS(DenseInverse()(ones.data(), std::vector{0, 3}), NotReached);
}

TEST_CASE("dense inverse: triangles need a sixth of the operations") {
  std::vector<int> cuts;
  for (int c = 0; c <= 512; c += 2) cuts.push_back(c);
  CHECK(DenseInverse::operations(std::vector{0, 512}) == Approx(2.0 * 512 * 512 * 512));
  CHECK(DenseInverse::operations(cuts) / DenseInverse::operations(std::vector{0, 512}) ==
        Approx(1.0 / 6).epsilon(0.02));
}
