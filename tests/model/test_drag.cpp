#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "stickslip/model/drag.hpp"

using stickslip::model::Drag;

TEST_CASE("drag: odd, non-increasing, zero at rest") {
  const Drag drag = GENERATE(Drag{1, 0}, Drag{0, 0}, Drag{0.3, 2}, Drag{0, 1.5});
  CHECK(drag(0) == 0);
  double before = 0;
  for (double v = 0.01; v < 30; v *= 1.3) {
    CHECK(drag(-v) == -drag(v));
    CHECK(drag(v) <= before);
    before = drag(v);
  }
}

TEST_CASE("drag: the potential is the integral of the force") {
  const Drag drag{0.7, 0.2};
  const double h = 1e-4;
  for (double v : {0.1, 1.0, 5.0}) {
    const double slope = (drag.potential(v + h) - drag.potential(v - h)) / (2 * h);
    CHECK(slope == Approx(drag(v)).epsilon(1e-7));
  }
  CHECK(drag.potential(0) == 0);
}

TEST_CASE("terminal velocity: the first point where force and drag balance, or no point at all") {
  CHECK(Drag{2, 0}.terminal_velocity(3) == 1.5);
  CHECK(Drag{0, 1}.terminal_velocity(8) == Approx(2).epsilon(1e-15));
  CHECK(Drag{1, 1}.terminal_velocity(10) == Approx(2).epsilon(1e-14));  // 2 + 8
  CHECK(Drag{1, 0}.terminal_velocity(-1) == 0);
  CHECK(std::isinf(Drag{0, 0}.terminal_velocity(1)));
  for (double force : {1e-9, 0.3, 7.75, 1e5}) {
    for (const Drag& drag : {Drag{0.7, 0}, Drag{0.1, 3}, Drag{1e-6, 1e-6}}) {
      const double v = drag.terminal_velocity(force);
      CHECK(force + drag(v) <= 0);
      CHECK(force + drag(v * (1 - 1e-12)) > 0);
    }
  }
}
