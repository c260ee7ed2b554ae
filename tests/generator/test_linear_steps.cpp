#include "../common/catch.hpp"
#include "stickslip/generator/element_system.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using LinearSteps = generator::LinearSteps<PetscScalar>;
using linalg::DenseMatrix;
using linalg::Scalars;

namespace {

constexpr std::size_t kSize = 6;

DenseMatrix matrix(int rows, int columns, double start) {
  DenseMatrix a(rows, columns);
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) a(r, c) = start + 0.3 * r - 0.7 * c * c + (r == c ? 3 : 0);
  }
  return a;
}

LinearSteps every_kind() {
  LinearSteps steps;
  steps.add(matrix(2, 3, 0.5), 3, 0);
  steps.solve(linalg::DenseFactors(matrix(3, 3, -0.2)), 1);
  steps.add({{0, 4, 2.0}, {4, 5, -1.5}});  // the second takes what the first has brought
  LinearSteps::Tridiagonal chain{{2.0, 3.0, 4.0}, {0.0, 1.0, -1.0}, {0.5, 0.25, 0.0}};
  chain.factor();
  steps.solve(std::move(chain), 2);
  steps.contract(std::vector{0.5, -2.0}, 2, 2, 0);
  steps.spread(std::vector{1.5, 0.25, 3.0}, 1, 0, 2);
  steps.add(matrix(1, 2, 1.5), 0, 5);
  return steps;
}

Scalars column(std::size_t n) {
  Scalars x(kSize, 0.0);
  x[n] = 1;
  return x;
}

}  // namespace

TEST_CASE("linear steps: the transposed map runs them backwards") {
  const LinearSteps steps = every_kind();
  for (std::size_t c = 0; c < kSize; ++c) {
    Scalars image = column(c);
    steps.run({image.data()}, false);
    for (std::size_t r = 0; r < kSize; ++r) {
      Scalars row = column(r);
      steps.run({row.data()}, true);
      INFO("entry " << r << ", " << c);
      CHECK(std::abs(row[c] - image[r]) < 1e-14);
    }
  }
}

TEST_CASE("linear steps: several lists at once, each as if it were alone") {
  const LinearSteps steps = every_kind();
  for (bool transposed : {false, true}) {
    DenseMatrix all(static_cast<int>(kSize) + 1, static_cast<int>(kSize));  // a row that stays
    for (int c = 0; c < all.columns(); ++c) {
      if (c != 2) all(c, c) = 1;
      all(static_cast<int>(kSize), c) = 7;
    }
    steps.run(columns_of(all), transposed);
    for (int c = 0; c < all.columns(); ++c) {
      Scalars alone = c == 2 ? Scalars(kSize, 0.0) : column(static_cast<std::size_t>(c));
      steps.run({alone.data()}, transposed);
      for (std::size_t r = 0; r < kSize; ++r) {
        INFO((transposed ? "transposed" : "forward") << ", entry " << r << ", " << c);
        CHECK(std::abs(all(static_cast<int>(r), c) - alone[r]) < 1e-14);
      }
      CHECK(all(static_cast<int>(kSize), c) == PetscScalar(7));
    }
  }
}

TEST_CASE("linear steps: each does its own, in its order") {
  LinearSteps steps;
  steps.add({{0, 1, 2.0}, {1, 2, 3.0}});
  DenseMatrix twice(1, 1);
  twice(0, 0) = 2;
  steps.solve(linalg::DenseFactors(twice), 0);
  steps.add(std::move(twice), 0, 3);
  Scalars w(4, 1.0);
  steps.run({w.data()}, false);
  CHECK(w == Scalars{0.5, 3.0, 10.0, 2.0});
  CHECK(steps.entries() == 2 * 2 + 1 + 1);
}

TEST_CASE("linear steps: contractions and their opposite, block by block") {
  LinearSteps steps;
  steps.contract(std::vector{2.0, 3.0}, 2, 2, 0);
  Scalars w{1, 1, 1, 2, 3, 4};
  steps.run({w.data()}, false);
  CHECK(w == Scalars{12, 17, 1, 2, 3, 4});
  LinearSteps back;
  back.spread(std::vector{2.0, 3.0}, 2, 0, 2);
  back.run({w.data()}, false);
  CHECK(w == Scalars{12, 17, 25, 36, 39, 55});
}

TEST_CASE("linear steps: a tridiagonal system, both ways") {
  LinearSteps::Tridiagonal chain{{4.0, 5.0, 6.0}, {0.0, 1.0, 2.0}, {-1.0, 0.5, 0.0}};
  const Scalars x{1.0, -2.0, 3.0};
  Scalars plain{4 * 1.0 - 1 * -2.0, 1 * 1.0 + 5 * -2.0 + 0.5 * 3.0, 2 * -2.0 + 6 * 3.0};
  Scalars transposed{4 * 1.0 + 1 * -2.0, -1 * 1.0 + 5 * -2.0 + 2 * 3.0, 0.5 * -2.0 + 6 * 3.0};
  chain.factor();
  chain.solve({plain.data()}, false);
  chain.solve({transposed.data()}, true);
  for (std::size_t n = 0; n < 3; ++n) {
    CHECK(std::abs(plain[n] - x[n]) < 1e-15);
    CHECK(std::abs(transposed[n] - x[n]) < 1e-15);
  }
}
