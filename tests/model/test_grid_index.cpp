#include <stdexcept>

#include "../common/catch.hpp"
#include "stickslip/model/drag.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/process.hpp"

using stickslip::model::floor_index;
using stickslip::model::Friction;
using stickslip::model::snapped_difference;

TEST_CASE("floor index: decimal thresholds on the grid are never moved by rounding") {
  for (int n = 1; n <= 5000; ++n) {
    for (int parts : {3, 7, 10, 100, 640}) {
      const double threshold = static_cast<double>(n) / parts;
      REQUIRE(floor_index(threshold / (1.0 / parts)) == n);
    }
  }
  CHECK(floor_index(0.3 / 0.1) == 3);
  CHECK(floor_index(2 / (0.1 * 0.1)) == 200);
}

TEST_CASE("floor index: thresholds 1e-12 off the grid keep their side") {
  for (double delta : {0.25, 0.1, 1.0 / 64}) {
    for (int n : {1, 3, 4, 17}) {
      const double point = n * delta;
      CHECK(floor_index(point * (1 - 1e-12) / delta) == n - 1);
      CHECK(floor_index(point * (1 + 1e-12) / delta) == n);
    }
  }
}

TEST_CASE("floor index: refuses what an int cannot hold") {
  CHECK_THROWS_AS(floor_index(1e10), std::out_of_range);
  CHECK_THROWS_AS(floor_index(std::numeric_limits<double>::infinity()), std::out_of_range);
  CHECK_THROWS_AS(floor_index(std::numeric_limits<double>::quiet_NaN()), std::out_of_range);
}

TEST_CASE("net force: a level that equals mu_d in decimals has none") {
  const Friction friction{1, 0.3};
  CHECK(3 * 0.1 != 0.3);  // why snapping is needed
  CHECK(friction.net_force(3 * 0.1) == 0);
  CHECK(friction.net_force(0.3 * (1 + 1e-12)) > 0);
  CHECK(friction.net_force(0.3 * (1 - 1e-12)) < 0);
  CHECK(snapped_difference(1, 0.25) == 0.75);
}

TEST_CASE("static index: x_k <= mu_s < x_{k+1}") {
  const auto index = [](double mu_s, double delta) {
    return stickslip::model::Process{{1, delta, 9}, {mu_s, mu_s}, {}}.highest_static();
  };
  CHECK(index(0.3, 0.1) == 3);
  CHECK(index(1, 0.25) == 4);
  CHECK(index(1, 0.3) == 3);
  CHECK(index(0.05, 0.1) == 0);
}

TEST_CASE("floor index: below zero, too, the largest integer that is not larger") {
  CHECK(floor_index(-0.5) == -1);
  CHECK(floor_index(-1.5) == -2);
  CHECK(floor_index(-0.3 / 0.1) == -3);
}
