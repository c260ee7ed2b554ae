#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/model/process.hpp"

using namespace stickslip;
using model::Process;

namespace {

// A drag that is three times as large upwards.
model::Drag one_sided() {
  model::Drag drag{0, 0, [](double v) { return v > 0 ? -3 * v : -v; }, 100};
  drag.law_is_odd = false;
  return drag;
}

}  // namespace

TEST_CASE("process: static levels shift against the bias") {
  struct Case {
    double bias;
    int lowest, highest;
  };
  for (const auto& c : {Case{0, -4, 4}, Case{0.1, -4, 3}, Case{0.25, -5, 3}, Case{-0.25, -3, 5},
                        Case{1.5, -10, -2}, Case{-3, 8, 16}}) {
    const Process process{{1, 0.25, 32}, {1, 0.5}, {1, 0}, c.bias};
    CHECK(process.lowest_static() == c.lowest);
    CHECK(process.highest_static() == c.highest);
    // By what static means.
    for (int i = -20; i <= 20; ++i) {
      const bool holds = std::abs(process.noise.level(i) + c.bias) <= 1 + 1e-12;
      CHECK(holds == (i >= c.lowest && i <= c.highest));
    }
  }
}

TEST_CASE("process: levels end, and a side from which nearly nothing starts does not count") {
  const auto process = [](double bias, double mu_s_minus, int levels) {
    return Process{{1, 0.125, levels}, {1, 1, mu_s_minus}, {1, 0}, bias};
  };
  // s- is next to x = -1, next to -12.5, with a share of about e^-80, and nowhere.
  const auto both = process(0, 1, 128), rare = process(0.25, 12.25, 128),
             none = process(0, 1e12, 128);
  CHECK((both.starts_upwards() && both.starts_downwards()));
  CHECK((rare.starts_upwards() && !rare.starts_downwards()));
  CHECK((none.starts_upwards() && !none.starts_downwards()));
  CHECK((none.mirrored().starts_downwards() && !none.mirrored().starts_upwards()));
  CHECK(none.lowest_static() == -128);
  CHECK(none.exit_level(false) == none.exit_level(true));
  CHECK_FALSE(process(0, 9, 6).starts_upwards());  // x <= 0.75
  CHECK_FALSE(Process{{1, 0.5, 8}, {0.1, 0.1}, {1, 0}, 0.2}.sticks());
}

TEST_CASE("process: the mirror swaps directions, and its own mirror is the process") {
  const Process process{{1, 0.25, 8}, {1, 0.5}, one_sided(), 0.3};
  const Process mirrored = process.mirrored();
  CHECK(mirrored.bias == -0.3);
  CHECK(mirrored.highest_static() == -process.lowest_static());
  CHECK(mirrored.drag(0.7) == -process.drag(-0.7));
  // Sliding downwards at -v: dv/dt = x + g + mu_d + b(-v), seen from below.
  CHECK(mirrored.net_force(-2) == Approx(-0.5 - 0.3 - 0.5));
  const Process back = mirrored.mirrored();
  CHECK(back.bias == process.bias);
  for (double v : {-2.0, 0.4, 3.0}) CHECK(back.drag(v) == process.drag(v));
}

TEST_CASE("process: bias and drag can break the symmetry") {
  CHECK(Process{{1, 0.25, 8}, {1, 0.5}, {1, 0.2}}.symmetric());
  CHECK_FALSE(Process{{1, 0.25, 8}, {1, 0.5}, {1, 0}, 1e-300}.symmetric());
  CHECK_FALSE(Process{{1, 0.25, 8}, {1, 0.5}, one_sided()}.symmetric());
}

TEST_CASE("process: a net force that vanishes but for rounding is 0, with a bias too") {
  const Process process{{1, 0.1, 100}, {1, 0.7}, {1, 0}, 0.4};
  CHECK(process.net_force(3) == 0);  // 0.3 + 0.4 - 0.7
  CHECK(process.net_force(4) > 0.09);
}

TEST_CASE("process: bodies tend to the velocity at which drag balances the highest level") {
  const Process process{{1, 0.25, 16}, {1, 0.5}, {2, 0}, 0.1};
  CHECK(process.terminal_velocity() == Approx((4 + 0.1 - 0.5) / 2));
  CHECK(process.mirrored().terminal_velocity() == Approx((4 - 0.1 - 0.5) / 2));
  CHECK(process.terminal_speed() == process.terminal_velocity());
  CHECK(process.mirrored().terminal_speed() == process.terminal_velocity());
}
