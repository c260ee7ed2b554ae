#include "stickslip/quantities/given_force.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include "../common/catch.hpp"
#include "../common/rigid_block.hpp"

using namespace stickslip;
using quantities::Results;

namespace {

model::Scene scene_with(model::ForceRecord record, double mu_s, double mu_d, double drag) {
  model::Scene scene;
  scene.noise.name.clear();
  scene.friction = {mu_s, mu_d};
  scene.drag = {drag, 0};
  scene.force = std::make_shared<const model::ForceRecord>(std::move(record));
  return scene;
}

const quantities::Result& named(const Results& results, std::string_view key) {
  const auto found = std::ranges::find(results, key, &quantities::Result::key);
  REQUIRE(found != results.end());
  return *found;
}

}  // namespace

TEST_CASE("given force: errors cover the distance to a rigid block, and little more") {
  for (const auto& record : test::records()) {
    for (double mu : {0.7, 0.31}) {
      Results results;
      CHECK(quantities::append_given_force(scene_with(record, mu, mu, 0), 1e-12, results).empty());
      const auto& v = named(results, "path_velocity");
      const auto& x = named(results, "path_displacement");
      test::Block block(mu, mu, 0);
      for (std::size_t n = 0; n + 1 < record.time.size(); ++n) {
        block.follow(record, n);
        const double floor = 1e-15 * named(results, "largest_displacement").value[0];
        REQUIRE(std::abs(v.value[n + 1] - static_cast<double>(block.v)) <=
                2 * v.error[n + 1] + floor);
        REQUIRE(std::abs(x.value[n + 1] - static_cast<double>(block.x)) <=
                2 * x.error[n + 1] + floor);
      }
      CHECK(quantities::relative_error(x) < 1e-12);
    }
  }
}

TEST_CASE("given force: what the slips add up to") {
  for (const auto& record : test::records()) {
    Results results;
    (void)quantities::append_given_force(scene_with(record, 0.8, 0.5, 0.3), 1e-10, results);
    const auto &displacement = named(results, "slip_displacement"),
               &peak = named(results, "slip_peak"), &begin = named(results, "slip_begin"),
               &end = named(results, "slip_end");
    double x = 0, time = 0;
    for (std::size_t n = 0; n < begin.value.size(); ++n) {
      CHECK(begin.value[n] < end.value[n]);
      x += displacement.value[n];
      time += end.value[n] - begin.value[n];
    }
    CHECK(x == Approx(named(results, "final_displacement").value[0]).epsilon(1e-13));
    CHECK(time / record.time.back() ==
          Approx(named(results, "sliding_share").value[0]).epsilon(1e-12));
    CHECK(std::ranges::max(peak.value) == named(results, "largest_speed").value[0]);
    CHECK(named(results, "slip_count").value[0] == static_cast<double>(begin.value.size()));
    CHECK(named(results, "slip_count").error[0] == 0);
  }
}

TEST_CASE("given force: where rounding decides on a slip, no error is small") {
  Results results;
  const auto missed = quantities::append_given_force(
      scene_with({{0, 1, 2, 3, 4}, {0, 1 + 2e-15, 0, 2, 0}}, 1, 0.5, 0), 0.1, results);
  CHECK_THAT(missed, Catch::Contains("rounding decides"));
  CHECK(named(results, "slip_count").error[0] > 0);
  CHECK(std::isinf(named(results, "slip_begin").error[0]));
}
