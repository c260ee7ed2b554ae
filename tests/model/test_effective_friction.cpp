#include "stickslip/model/process.hpp"

#include <memory>
#include <vector>

#include "../common/catch.hpp"
#include "../common/scenes.hpp"

using namespace stickslip;
using model::effective_mu_s;
using test::scene;

TEST_CASE("effective friction: nothing where mu_s is a level, up to rounding") {
  for (const auto& s : {scene(1, 0.5, 1, 0.125, {1, 0}), scene(1.1, 0.5, 1, 1.1 / 7, {1, 0}),
                        scene(0.3, 0.1, 1, 0.1, {1, 0})}) {
    CHECK_FALSE(effective_mu_s(s, false));
    CHECK_FALSE(effective_mu_s(s, true));
  }
}

TEST_CASE("effective friction: the highest level at or below mu_s") {
  const auto between = scene(1.07, 0.5, 1, 0.125, {1, 0});
  CHECK(*effective_mu_s(between, false) == 1);
  CHECK(*effective_mu_s(between, true) == 1);
  CHECK(*effective_mu_s(scene(0.1, 0.1, 1, 0.125, {1, 0}), false) == 0);
}

// Levels from -1.25 to 0.625 stick: |x + 0.3| <= 1.
TEST_CASE("effective friction: with a bias, and by direction") {
  auto s = scene(1, 0.5, 1, 0.125, {1, 0});
  s.bias = 0.3;
  CHECK(*effective_mu_s(s, false) == Approx(0.925));
  CHECK(*effective_mu_s(s, true) == Approx(0.95));
  s.bias = 0.25;
  CHECK_FALSE(effective_mu_s(s, false));
  s.friction.mu_s_minus = 1.3;
  CHECK_FALSE(effective_mu_s(s, false));
  CHECK(*effective_mu_s(s, true) == Approx(1.25));
}

// Levels from -2.25 to 2.25 are all pushed on; 1e-8 lies a ten-millionth of a step above a level.
TEST_CASE("effective friction: nothing where no level holds, and where no result could tell") {
  auto s = scene(1, 0.5, 1, 0.75, {1, 0});
  s.bias = 4;
  CHECK_FALSE(effective_mu_s(s, false));
  CHECK_FALSE(effective_mu_s(s, true));
  CHECK_FALSE(effective_mu_s(scene(1e-8, 1e-8, 1, 0.125, {1, 0}), false));
}

TEST_CASE("effective friction: levels of a file are what they are") {
  auto s = scene(1.07, 0.5, 1, 0.125, {1, 0});
  s.noise.name = "telegraph";
  s.noise.table =
      std::make_shared<const model::LevelTable>(std::vector<model::Level>{{-1, 1, 0}, {1.5, 0, 1}});
  CHECK_FALSE(effective_mu_s(s, false));
}
