#include <vector>

#include "../common/catch.hpp"
#include "../common/matrices.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/solver.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using namespace stickslip::linalg;

namespace {

// (1 -2; 0 4)
MatHandle triangle() {
  return test::matrix(2, [](PetscInt r) {
    return r == 0 ? test::Row{{0, 1}, {1, -2}} : test::Row{{1, 4}};
  });
}

VecHandle vector(Mat a, const std::vector<double>& values) {
  VecHandle x;
  check(MatCreateVecs(a, x.out(), nullptr));
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(x, &begin, &end));
  for (PetscInt n = begin; n < end; ++n) check(VecSetValue(x, n, values[n], INSERT_VALUES));
  check(VecAssemblyBegin(x));
  check(VecAssemblyEnd(x));
  return x;
}

struct Measured {
  double forward, transposed;
};

Measured measured(BackwardError& measure, Mat a, const std::vector<double>& r,
                  const std::vector<double>& b, const std::vector<double>& x) {
  const double forward = measure.forward(vector(a, r), vector(a, b), vector(a, x));
  return {forward, measure.transposed(vector(a, r), vector(a, b), vector(a, x))};
}

}  // namespace

TEST_CASE("backward error: by hand, row by row and as a share of all visits", "[parallel]") {
  const MatHandle a = triangle();
  BackwardError measure(a);
  // |A| |x| + |b| = (1 + 6 + 3, 12 + 8); the rows of |A| sum to 3 and 4, so that |x| makes 15
  // visits and |b| is 11.
  const auto first = measured(measure, a, {0.5, -0.25}, {-3, 8}, {1, -3});
  CHECK(first.forward == Approx(0.05).epsilon(1e-11));
  CHECK(first.transposed == Approx(0.75 / 26).epsilon(1e-14));
  const auto second = measured(measure, a, {0.5, -4}, {-3, 8}, {1, -3});
  CHECK(second.forward == Approx(0.2).epsilon(1e-11));
  CHECK(second.transposed == Approx(4.5 / 26).epsilon(1e-14));
}

TEST_CASE("backward error: components below 1e-13 of the largest need no digits", "[parallel]") {
  const MatHandle a = triangle();
  BackwardError measure(a);
  // The second row sees |x_2| = 0 and no b, but 4e-13 of the largest component, 5.
  CHECK(measured(measure, a, {0, 1e-12}, {5, 0}, {5, 0}).forward == Approx(0.5).epsilon(1e-9));
}
