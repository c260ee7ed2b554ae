#include <limits>

#include "../common/catch.hpp"
#include "../common/made_results.hpp"
#include "stickslip/case/sticking_rows.hpp"
#include "stickslip/run/estimates.hpp"

using namespace stickslip;
using quantities::Kind;
using quantities::Result;
using run::broken_bound;

namespace {

Result transform(std::vector<double> values, double error = 0) {
  const std::vector<double> errors(values.size(), error);
  return {"F_slide", "", "lambda", {2, 0.5, 1}, std::move(values), errors, Kind::transform};
}

}  // namespace

TEST_CASE("result bounds: sound results pass") {
  CHECK(broken_bound({}).empty());
  CHECK(broken_bound(
            {quantities::scalar(cases::kPStick, 1, 0),
             quantities::scalar(cases::kEXV, -3, 0),
             transform({0.2, 0.6, 0.4}),
             {"cdf_slide", "", "time", {1, 2, 3}, {0, 0.5, 1}, {0, 0, 0}, Kind::distribution}})
            .empty());
  CHECK(broken_bound({transform({1 / 3., 1 / 3., 1 / 3.})}).empty());
}

TEST_CASE("result bounds: errors excuse what they cover") {
  CHECK(broken_bound({transform({0.41, 0.6, 0.4}, 0.006)}).empty());
  CHECK(broken_bound({quantities::scalar(cases::kPSlide, 1.01, 0.02)}).empty());
}

TEST_CASE("result bounds: every violation is reported with its place") {
  CHECK(broken_bound({transform({0.41, 0.6, 0.4})}) ==
        "F_slide rises from 0.4 at lambda = 1 to 0.41 at lambda = 2");
  CHECK(broken_bound({transform({0.2, 1.5, 0.4})}) == "F_slide is 1.5 at lambda = 0.5");
  CHECK(broken_bound({quantities::scalar(cases::kPStick, -0.1, 0.01)}) == "P_stick is -0.1");
  CHECK(broken_bound({{"cdf_stick", "", "time", {1, 2}, {0.5, 0.4}, {0, 0}, Kind::distribution}}) ==
        "cdf_stick falls from 0.5 at time = 1 to 0.4 at time = 2");
  CHECK(broken_bound({quantities::scalar(cases::kEV2, -1, 0)}) == "E_V2 is -1");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(broken_bound({quantities::scalar(cases::kMeanSlide, nan, 0)}) == "mean_slide is nan");
}

TEST_CASE("result bounds: an entry without a value, for a reason, breaks none") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto falls = transform({nan, 0.6, 0.4});
  falls.unreached = "is beyond double precision";
  CHECK(broken_bound({falls}).empty());
  falls.value[2] = 0.7;
  CHECK(broken_bound({falls}) == "F_slide rises from 0.6 at lambda = 0.5 to 0.7 at lambda = 1");
  falls.unreached.clear();
  CHECK_FALSE(broken_bound({falls}).empty());
}

TEST_CASE("result bounds: an error excuses its own size, and 1e-10, and no more") {
  const auto passes = [](Kind kind, double value, double error) {
    auto result = test::scalar("a", "", value, error);
    result.kind = kind;
    return broken_bound({result}).empty();
  };
  for (Kind kind : {Kind::probability, Kind::share, Kind::transform, Kind::distribution}) {
    CHECK(passes(kind, 1.0099, 0.01));
    CHECK_FALSE(passes(kind, 1.0101, 0.01));
  }
  for (Kind kind : {Kind::probability, Kind::share, Kind::transform, Kind::distribution,
                    Kind::positive_mean, Kind::spectrum}) {
    CHECK(passes(kind, -0.0099, 0.01));
    CHECK_FALSE(passes(kind, -0.0101, 0.01));
    CHECK(passes(kind, -0.9e-10, 0));
    CHECK_FALSE(passes(kind, -1.1e-10, 0));
  }
  for (Kind kind : {Kind::positive_mean, Kind::spectrum, Kind::other}) CHECK(passes(kind, 1e6, 0));
  for (Kind kind : {Kind::mean, Kind::drift, Kind::other}) CHECK(passes(kind, -1, 0));
}

TEST_CASE("result bounds: two values in the wrong order are excused by both their errors") {
  const auto passes = [](double rise, double first, double second) {
    return broken_bound({{"F_stick",
                          "",
                          "lambda",
                          {1, 2},
                          {0.5, 0.5 + rise},
                          {first, second},
                          Kind::transform}})
        .empty();
  };
  CHECK(passes(0.0109, 0.01, 0.001));
  CHECK(passes(0.0109, 0.001, 0.01));
  CHECK_FALSE(passes(0.0111, 0.01, 0.001));
  CHECK(passes(0.9e-10, 0, 0));
  CHECK_FALSE(passes(1.1e-10, 0, 0));
}

TEST_CASE("result bounds: simulated results scatter, and are left alone") {
  Result simulated = transform({0.41, 0.6, 0.4});
  simulated.ci95.assign(3, {0, 1});
  CHECK(broken_bound({simulated}).empty());
}

TEST_CASE("results: what is not a number has no finite error") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(quantities::relative_error(test::scalar("a", "", nan, 0)) < 1e300);
  CHECK_FALSE(quantities::relative_error(test::scalar("a", "", 1, nan)) < 1e300);
  CHECK(quantities::relative_error(test::scalar("a", "", 0, 0)) == 0);
}
