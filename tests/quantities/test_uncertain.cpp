#include <cmath>
#include <limits>
#include <vector>

#include "../common/catch.hpp"
#include "../common/made_results.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/quantities/results.hpp"

using namespace stickslip;
using quantities::Result;
using quantities::Uncertain;

namespace {

// Largest deviation of f(a, b) when each argument is off by its error, up or down.
template <class F>
double worst(F f, Uncertain a, Uncertain b) {
  double largest = 0;
  for (double s : {-1.0, 1.0}) {
    for (double t : {-1.0, 1.0}) {
      const double there = f(a.value + s * a.error, b.value + t * b.error);
      largest = std::max(largest, std::abs(there - f(a.value, b.value)));
    }
  }
  return largest;
}

Result several(std::vector<double> values, std::vector<double> errors) {
  Result r = test::array("a", "", "n", {1, 2, 3});
  r.value = std::move(values);
  r.error = std::move(errors);
  return r;
}

}  // namespace

TEST_CASE("uncertain: bounds are the worst cases, to first order and attained") {
  const double e = 1e-7;
  for (double a_value : {3.0, -0.2}) {
    for (double b_value : {-5.0, 0.5}) {
      for (const auto& [share_a, share_b] : {std::pair{1.0, 0.3}, {0.0, 1.0}, {1.0, 0.0}}) {
        const Uncertain a{a_value, share_a * e}, b{b_value, share_b * e};
        const auto check = [&](Uncertain found, auto f) {
          CHECK(found.value == Approx(f(a.value, b.value)).epsilon(1e-15));
          CHECK(found.error == Approx(worst(f, a, b)).epsilon(1e-5));
        };
        INFO("a " << a_value << " b " << b_value << " errors " << share_a << " " << share_b);
        check(a + b, [](double x, double y) { return x + y; });
        check(a - b, [](double x, double y) { return x - y; });
        check(a * b, [](double x, double y) { return x * y; });
        check(a / b, [](double x, double y) { return x / y; });
        check(-2.5 * a, [](double x, double) { return -2.5 * x; });
      }
    }
  }
}

TEST_CASE("uncertain: a functional is off by the effect of iterative refinement", "[parallel]") {
  const auto constant = [](double value) {
    linalg::VecHandle x;
    linalg::check(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, 6, x.out()));
    linalg::check(VecSet(x, value));
    return x;
  };
  linalg::Solution s{constant(3), constant(-0.25)};
  const Uncertain found = quantities::value_of(constant(2), s);
  CHECK(found.value == 36);
  CHECK(found.error == 3);
}

TEST_CASE("results: relative errors are to the largest value, or to each by its size") {
  Result r = several({4, -8, 0}, {1, 1, 1});
  CHECK(quantities::relative_error(r) == 0.125);
  r.each_by_its_size = true;
  r.value[2] = -2;
  CHECK(quantities::relative_error(r) == 0.5);
  r.value[2] = 0;
  CHECK(quantities::relative_error(r) == std::numeric_limits<double>::infinity());
  r.error[2] = 0;  // exactly 0, without error
  CHECK(quantities::relative_error(r) == 0.25);
  CHECK(quantities::relative_error(several({0, 0, 0}, {0, 0, 0})) == 0);
}
