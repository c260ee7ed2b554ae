#include <algorithm>
#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/model/breaks.hpp"

using stickslip::model::Break;
using stickslip::model::breaks;
using stickslip::model::FunctionOfSpeed;

namespace {

std::vector<double> places(const FunctionOfSpeed& f, const std::vector<double>& numbers = {},
                           double reach = 20) {
  std::vector<double> v;
  for (const Break& b : breaks(f, numbers, reach)) v.push_back(b.v);
  return v;
}

using Speeds = std::vector<double>;

}  // namespace

// Numbers of a formula, and sums, differences, products and quotients of two.
TEST_CASE("breaks: those at numbers are exact") {
  CHECK(places([](double v) { return std::abs(v - 0.3); }, {0.3}) == Speeds{0.3});
  CHECK(places([](double v) { return std::min(v, 0.1 + 0.7); }, {0.1, 0.7}) == Speeds{0.1 + 0.7});
  CHECK(places([](double v) { return v > 3 * 0.7; }, {3, 0.7}) == Speeds{3 * 0.7});
  CHECK(places([](double v) { return std::floor(v / 0.3); }, {0.3}, 0.7) == Speeds{0.3, 0.6});
  CHECK(places([](double v) { return std::pow(std::max(0.0, v - 1.3), 2); }, {1.3}) == Speeds{1.3});
  CHECK(places([](double v) { return std::sqrt(std::abs(v - 2)); }, {2}) == Speeds{2});
  CHECK(places([](double v) { return std::abs(v - 11.1) < 1e-6; }, {11.1, 1e-6}) ==
        Speeds{11.1 - 1e-6, 11.1 + 1e-6});
  CHECK(places([](double v) { return v > 5; }, {5}, 4).empty());
}

TEST_CASE("breaks: without numbers jumps to the precision of v, kinks to the root of rounding") {
  for (double c : {0.0123, 0.5, std::sqrt(2.0), 4.0, 17.77}) {
    INFO(c);
    const auto jump = places([c](double v) { return v * v + 0.01 * (v >= c); });
    REQUIRE(jump.size() == 1);
    CHECK(jump[0] == Approx(c).epsilon(4e-16));
    const auto kink = places([c](double v) { return std::exp(-v) + std::max(0.0, v - c); });
    REQUIRE(kink.size() == 1);
    CHECK(kink[0] == Approx(c).margin(1e-8));
    const auto curved = places([c](double v) { return std::pow(std::max(0.0, v * v - c * c), 2); });
    REQUIRE(curved.size() == 1);
    CHECK(curved[0] == Approx(c).epsilon(1e-5));
  }
  CHECK(places([](double v) { return std::floor(3 * v); }).size() == 60);
  // One beside the other.
  CHECK(places([](double v) { return (v > 0.5) + std::abs(v - 0.503); }).size() == 2);
}

TEST_CASE("breaks: none where doubles resolve a function, however steep, nor in rounding") {
  for (double width : {1.0, 1e-2, 1e-4, 1e-6}) {
    INFO(width);
    CHECK(places([=](double v) { return std::tanh((v - 0.5) / width); }, {0.5, width}).empty());
    CHECK(places([=](double v) { return std::exp(-std::pow((v - 3) / width, 2)); }, {3}).empty());
  }
  for (double power : {0.5, 1.5, 2.0, 9.0}) {
    CHECK(places([=](double v) { return std::pow(v, power); }, {power}).empty());
  }
  CHECK(places([](double v) { return std::sin(300 * v); }, {300}).empty());
  CHECK(places([](double v) { return v * v - 0.25; }, {2, 0.25, 0.5}).empty());
  CHECK(places([](double v) { return (1 - std::cos(v)) / (v * v); }, {1, 2}).empty());
  CHECK(places([](double v) { return std::exp(-v * v); }, {}, 100).empty());  // 0 in the end
  CHECK(places([](double) { return 0.0; }).empty());
  CHECK(places([](double v) { return 1 + std::tanh((v - 5) / 0.2); }, {5, 0.2}).empty());
}

TEST_CASE("breaks: a pole is unbounded, a jump, a root and a logarithm are not") {
  const auto found = [](const FunctionOfSpeed& f) {
    return breaks(f, {0.7, 0.69}, 20).at(0).unbounded;
  };
  CHECK(found([](double v) { return 1 / (v - 0.7); }));
  CHECK(found([](double v) { return 1 / std::sqrt(std::abs(v - 0.7)); }));
  CHECK_FALSE(found([](double v) { return v > 0.7; }));
  CHECK_FALSE(found([](double v) { return std::sqrt(std::abs(v - 0.7)); }));
  CHECK_FALSE(found([](double v) { return std::log(std::abs(v - 0.69)); }));
}

TEST_CASE("breaks: of two at one place the sharper one stays") {
  std::vector<Break> found{{0.5, 1e-7, false}, {2, 1e-7, false}};
  stickslip::model::merge(found, {{0.50000001, 1e-15, false}, {1, 1e-15, true}});
  REQUIRE(found.size() == 3);
  CHECK(found[0].v == 0.50000001);
  CHECK(found[1].unbounded);
  CHECK(found[2].v == 2);
}

// The 8 nodes make it exact up to degree 7; at degree 8 the error is 2 (width/4)^8.
TEST_CASE("breaks: the error of interpolation") {
  using stickslip::model::interpolation_error;
  const auto power = [](int n) { return [n](double v) { return std::pow(v, n); }; };
  CHECK(interpolation_error(power(7), 0.5, 1.5) < 1e-13);
  CHECK(interpolation_error(power(8), 0.5, 1.5) == Approx(2 * std::pow(0.25, 8)).epsilon(1e-6));
  CHECK(interpolation_error([](double v) { return v > 1; }, 0.5, 1.5) > 0.1);
  CHECK(std::isnan(interpolation_error([](double v) { return std::sqrt(v - 1); }, 0.5, 1.5)));
}

TEST_CASE("breaks: the numbers of a formula") {
  CHECK(stickslip::model::numbers_in("log10(2*v) + 1.5e-3*x1 - .25") == Speeds{2, 1.5e-3, 0.25});
}
