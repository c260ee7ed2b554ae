#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/model/process.hpp"

using namespace stickslip;
using model::Drag;
using model::Friction;
using model::Stribeck;

namespace {

Friction weakening(double velocity, double exponent = 1) {
  return {1, 0.4, {}, {}, Stribeck{velocity, exponent}};
}

}  // namespace

TEST_CASE("friction: falls from mu_s to mu_d within speeds of v_s") {
  for (double exponent : {0.5, 1.0, 2.0}) {
    const Friction f = weakening(0.1, exponent);
    CHECK(f.at_rest() == 1);
    CHECK(f(0.1) == Approx(0.4 + 0.6 * std::exp(-1)).epsilon(1e-15));
    CHECK(f(1e6) == Approx(0.4).epsilon(1e-15));
    // No digit is lost at rest.
    CHECK(f.weakening(1e-20) == Approx(0.6 * std::pow(1e-19, exponent)).epsilon(1e-9));
    const double h = 1e-4;
    const double change =
        weakening(0.1 + h, exponent).share(0.2) - weakening(0.1 - h, exponent).share(0.2);
    CHECK(f.stribeck->share_by_velocity(0.2) == Approx(change / (2 * h)).epsilon(1e-5));
  }
  const Friction coulomb{1, 0.4};
  CHECK_FALSE(coulomb.weakens());
  CHECK(coulomb.at_rest() == 0.4);
  CHECK(coulomb(3) == 0.4);
}

TEST_CASE("friction: what it loses to the speed is a part of the drag, by direction") {
  Friction f = weakening(0.1);
  for (const Drag& drag : {Drag{0, 0}, Drag{2, 0}, Drag{1, 0.5}}) {
    const Drag all = with_weakening(drag, f);
    CHECK(all.odd());
    CHECK_FALSE(all.is_none());
    CHECK_FALSE(all.is_linear());
    for (double v : {1e-9, 0.05, 0.3, 4.0}) {
      CHECK(all(v) == Approx(drag(v) + 0.6 * (1 - std::exp(-v / 0.1))).epsilon(1e-6));
      CHECK(all(-v) == -all(v));
    }
  }
  f.mu_s_minus = 2;
  const Drag lopsided = with_weakening({1, 0}, f);
  CHECK_FALSE(lopsided.odd());
  CHECK(lopsided(-0.3) == Approx(0.3 - 1.6 * (1 - std::exp(-3))).epsilon(1e-14));
  const model::Process process{{1, 0.25, 8}, f, lopsided};
  CHECK(process.mirrored().friction.at_rest() == 2);
  CHECK(process.mirrored().drag(0.3) == -lopsided(-0.3));
  CHECK(process.net_force(5) == 0.25);  // against mu_s
  const Friction level{0.7, 0.7, {}, {}, Stribeck{0.1}};
  CHECK(with_weakening({1, 0}, level).is_linear());
}

TEST_CASE("drag that rises: the forces that it balances, and where bodies from rest end") {
  // -0.4 + 0.6 (1 - exp(-10 v)) - v: falls, rises and falls.
  const Drag all = with_weakening({1, 0}, weakening(0.1));
  const auto zeros = all.balances(-0.1);
  REQUIRE(zeros.size() == 2);
  for (double v : zeros) CHECK(std::abs(all(v) - 0.1) < 1e-15);
  CHECK(all(zeros[0] / 2) < 0.1);
  CHECK(all((zeros[0] + zeros[1]) / 2) > 0.1);
  CHECK(all(2 * zeros[1]) < 0.1);
  CHECK(all.balances(-0.7).empty());
  REQUIRE(all.balances(0.1).size() == 1);
  CHECK(all.terminal_velocity(0.1) == all.balances(0.1)[0]);
  // From rest a body never passes the first balance: v = 1 of 1 - v + 0.9 (1 - exp(-((v/2)^8))).
  const Drag late = model::with_weakening({1, 0}, {1, 0.1, {}, {}, Stribeck{2, 8}});
  const double first = late.terminal_velocity(1);
  CHECK(late.balances(1).front() == first);
  CHECK(first == Approx(1.0035).epsilon(1e-3));
  CHECK(1 + late(first) <= 0);
  CHECK(1 + late(std::nextafter(first, 0)) > 0);
}

TEST_CASE("drag that rises: slopes of either sign, and no bound on velocities by friction") {
  const Drag alone = with_weakening({0, 0}, weakening(0.1));
  CHECK(alone.slope_at_rest() == Approx(6).epsilon(1e-9));
  CHECK(alone.steepest(1) >= 5);
  CHECK(alone.steepest(1) <= 6);
  CHECK_FALSE(alone.bounds_velocity());
  CHECK(with_weakening({1e-3, 0}, weakening(0.1)).bounds_velocity());
  CHECK(std::isinf(alone.terminal_velocity(1)));
  CHECK(alone.potential(0.5) == Approx(0.6 * (0.5 - 0.1 * (1 - std::exp(-5)))).epsilon(1e-12));
}
