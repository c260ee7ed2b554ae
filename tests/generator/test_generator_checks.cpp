#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/generator/generator.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using namespace stickslip::generator;

namespace {

const model::Process scene{{2, 0.5, 4}, {1, 0.25}, {}};

// Two rows of three states: 1 -> 0 at rate 2, 1 -> 2 at rate 3; 2 -> 1 at rate 4.
struct Rows {
  std::vector<PetscInt> start{0, 3, 5}, columns{0, 1, 2, 1, 2};
  std::vector<PetscScalar> values{-2, 5, -3, -4, 4};
  void require(Promise promise) const {
    require_generator(PETSC_COMM_SELF, {1, start, columns, values}, promise, scene);
  }
};

}  // namespace

TEST_CASE("generator checks: a generator passes") {
  const Rows rows;
  CHECK_NOTHROW(rows.require({true, true}));
}

TEST_CASE("generator checks: a negative rate, a wrong row sum and what is no number are reported") {
  Rows rows;
  rows.values[0] = 2;
  CHECK_THROWS_WITH(rows.require({true, false}), Catch::Contains("rate of -2 in row 1") &&
                                                     Catch::Contains("mu_d = 0.25") &&
                                                     Catch::Contains("please report"));
  CHECK_NOTHROW(rows.require({false, false}));
  CHECK_THROWS_WITH(rows.require({false, true}), Catch::Contains("row sum of 4 in row 1"));
  rows.values = {-2, 5, -3, -4, 4.5};
  CHECK_NOTHROW(rows.require({true, false}));  // killed
  CHECK_THROWS_WITH(rows.require({true, true}), Catch::Contains("row sum of 0.5 in row 2"));
  rows.values[4] = 3;
  CHECK_THROWS_WITH(rows.require({true, false}), Catch::Contains("killing rate of -1 in row 2"));
  rows.values[4] = std::nan("");
  CHECK_THROWS_AS(rows.require({true, false}), NotReached);
  rows.values = {std::nan(""), 5, -3, -4, 4};
  CHECK_THROWS_AS(rows.require({true, false}), NotReached);
}

TEST_CASE("generator checks: row sums may be off by a rounding of 1e-12 of the diagonal") {
  Rows rows;
  for (double sign : {1.0, -1.0}) {
    rows.values = {-2, 5 + sign * 0.9 * 5e-12, -3, -4, 4};
    CHECK_NOTHROW(rows.require({true, true}));
    rows.values[1] = 5 + sign * 1.1 * 5e-12;
    CHECK_THROWS_WITH(rows.require({false, true}), Catch::Contains("row sum"));
  }
  CHECK_THROWS_WITH(rows.require({true, false}), Catch::Contains("killing rate"));
}

TEST_CASE("generator checks: an occupation below zero is reported", "[parallel]") {
  linalg::VecHandle nu;
  linalg::check(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, 10, nu.out()));
  linalg::check(VecSet(nu, 1));
  const auto put = [&](double value) {
    linalg::check(VecSetValue(nu, 7, value, INSERT_VALUES));
    linalg::check(VecAssemblyBegin(nu));
    linalg::check(VecAssemblyEnd(nu));
  };
  CHECK_NOTHROW(require_occupation(nu, scene));
  put(-0.9e-9);
  CHECK_NOTHROW(require_occupation(nu, scene));
  put(-1.1e-9);
  CHECK_THROWS_AS(require_occupation(nu, scene), NotReached);
  put(-1e-3);
  CHECK_THROWS_WITH(require_occupation(nu, scene),
                    Catch::Contains("from -0.001 to 1") && Catch::Contains("delta = 0.5"));
}
