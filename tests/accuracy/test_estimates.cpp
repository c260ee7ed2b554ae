#include <catch2/catch.hpp>

#include "stickslip/accuracy/estimates.hpp"

using namespace stickslip;
using accuracy::add_discretisation;
using accuracy::Changes;
using quantities::array;
using quantities::Kind;
using quantities::Result;
using quantities::Results;
using quantities::scalar;

namespace {

Result modes(std::vector<double> values, std::vector<double> errors) {
  Result r = array("relaxation_odd", "1/time", "mode", {1, 2, 3});
  r.value = std::move(values);
  r.error = std::move(errors);
  return r;
}

std::vector<double> errors(const Results& results) {
  std::vector<double> all;
  for (const auto& r : results) all.insert(all.end(), r.error.begin(), r.error.end());
  return all;
}

void check_errors(const Results& results, const std::vector<double>& expected) {
  const auto found = errors(results);
  REQUIRE(found.size() == expected.size());
  for (std::size_t n = 0; n < found.size(); ++n) {
    INFO("error " << n);
    CHECK(found[n] == Approx(expected[n]).epsilon(1e-12));
  }
}

}  // namespace

TEST_CASE("estimates: rounding is the least error, of every entry") {
  Results results{scalar("a", "", -2, 0), scalar("b", "", 3, 1), modes({1, -4, 0}, {0, 5, 6})};
  accuracy::require_rounding(0.25, results);
  check_errors(results, {0.5, 1, 0.25, 5, 6});
}

TEST_CASE("estimates: the larger of two changes is added, each by its factor") {
  const Results coarse{scalar("f", "", 3, 9), modes({1, 2}, {9, 9})};
  Results results{scalar("f", "", 1, 0.5), modes({2, 2.5, 7}, {0, 0.25, 0})};
  // The last change rules the first mode, the earlier one the scalar and the second mode.
  const Changes before{{20}, {4, 40}};
  const Changes changes = add_discretisation({3, 0.5}, coarse, before, results);
  check_errors(results, {0.5 + 10, 3, 0.25 + 20, 21});
  CHECK(changes == Changes{{2}, {1, 0.5, 7}});  // the third mode is new, and all change
}

TEST_CASE("estimates: without an earlier change the last one counts alone") {
  Results results{scalar("f", "", 1, 0.5)};
  (void)add_discretisation({3, 0.5}, {scalar("f", "", 3, 9)}, {}, results);
  check_errors(results, {6.5});
}

TEST_CASE("estimates: a change through zero is no small error, as the other means show") {
  Results results{scalar(quantities::kMeanSlide, 10, 0), scalar(quantities::kEV2, 4, 1e-9)};
  const Results coarse{scalar(quantities::kMeanSlide, 8, 0), scalar(quantities::kEV2, 4, 0)};
  (void)add_discretisation({1, 0}, coarse, {}, results);
  check_errors(results, {2, 0.05 * 0.2 * 4});
}

TEST_CASE("estimates: means share a twentieth of the largest relative error") {
  Results results{scalar(quantities::kMeanStick, 10, 2),  // 0.2, the largest
                  scalar(quantities::kEV2, -4, 1e-6),      scalar(quantities::kEAbsV, 2, 0.1),
                  scalar(quantities::kEV, 0.5, 100),       scalar(quantities::kFStick0, 1, 1e-6),
                  scalar(quantities::kMeanSlide, 3, 2e-13)};
  accuracy::share_errors(results);
  // E_V may vanish: it takes its share, and gives none. A density is no mean. A mean that does not
  // change stays.
  check_errors(results, {2, 0.01 * 4, 0.1, 100, 1e-6, 2e-13});
  Results drift{scalar(quantities::kMeanStick, 10, 2), scalar(quantities::kEV, 0.5, 1e-6)};
  accuracy::share_errors(drift);
  check_errors(drift, {2, 0.01 * 0.5});
}

TEST_CASE("estimates: a mean changes as soon as it does so by 1e-13") {
  Results results{scalar(quantities::kMeanStick, 10, 2), scalar(quantities::kEV2, 4, 4.1e-13),
                  scalar(quantities::kEXV, 4, 3.9e-13)};
  accuracy::share_errors(results);
  check_errors(results, {2, 0.04, 3.9e-13});
}

// P_stick = 1/(1 + q), q = mean_slide/mean_stick: dP_stick = P_stick P_slide dq/q.
TEST_CASE("estimates: probabilities of the phases share what their ratio does") {
  Results results{scalar(quantities::kPStick, 0.2, 1e-6), scalar(quantities::kPSlide, 0.8, 1e-6),
                  scalar(quantities::kMeanStick, 10, 5), scalar(quantities::kPWithin, 0.5, 1e-6)};
  accuracy::share_errors(results);
  check_errors(results, {0.05 * 0.5 * 0.16, 0.05 * 0.5 * 0.16, 5, 1e-6});
  Results exact{scalar(quantities::kPStick, 0.2, 0), scalar(quantities::kPSlide, 0.8, 0.7),
                scalar(quantities::kMeanStick, 10, 5)};
  accuracy::share_errors(exact);
  check_errors(exact, {0, 0.7, 5});
}

TEST_CASE("estimates: arrays keep their own errors") {
  Result array_of_means = modes({1, 2, 3}, {1e-6, 1e-6, 1e-6});
  array_of_means.kind = Kind::mean;
  Results results{scalar(quantities::kMeanStick, 10, 5), array_of_means};
  accuracy::share_errors(results);
  check_errors(results, {5, 1e-6, 1e-6, 1e-6});
}
