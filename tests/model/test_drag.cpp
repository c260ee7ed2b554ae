#include <cmath>
#include <limits>

#include "../common/catch.hpp"
#include "stickslip/model/drag.hpp"

using stickslip::model::Drag;

namespace {

Drag law(double (*b)(double)) { return {0, 0, b}; }

const Drag kSaturating = law([](double v) { return -std::tanh(v); });
const Drag kQuadratic = law([](double v) { return -v - 0.1 * v * std::abs(v); });

}  // namespace

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

TEST_CASE("drag laws: slope at rest from one side, on any scale") {
  CHECK(kQuadratic.slope_at_rest() == Approx(-1).epsilon(1e-10));
  CHECK(kSaturating.slope_at_rest() == Approx(-1).epsilon(1e-10));
  const auto steep = law([](double v) { return -std::tanh(1e5 * v); });
  CHECK(steep.slope_at_rest() == Approx(-1e5).epsilon(1e-8));
  const auto flat = law([](double v) { return -std::pow(v, 5); });
  CHECK(std::abs(flat.slope_at_rest()) < 1e-12);
  CHECK(flat.slope_at_rest() <= 0);
  const auto both = law([](double v) { return v > 0 ? -v : -3 * v; });
  CHECK(both.slope_at_rest() == Approx(-1).epsilon(1e-10));
  CHECK(both.mirrored().slope_at_rest() == Approx(-3).epsilon(1e-10));
}

TEST_CASE("drag laws: potentials are known integrals") {
  for (double v : {1e-6, 0.3, 4.0, 30.0}) {
    INFO(v);
    CHECK(kQuadratic.potential(v) == Approx(-v * v / 2 - v * v * v / 30).epsilon(1e-13));
    const double log_cosh = v < 1e-3 ? v * v / 2 : v + std::log1p(std::exp(-2 * v)) - std::log(2);
    CHECK(kSaturating.potential(v) == Approx(-log_cosh).epsilon(1e-12));
  }
}

TEST_CASE("drag laws: terminal velocity, none where drag saturates below the force") {
  CHECK(kSaturating.terminal_velocity(0.5) == Approx(std::atanh(0.5)).epsilon(1e-14));
  CHECK(std::isinf(kSaturating.terminal_velocity(1.01)));
  CHECK_FALSE(kSaturating.bounds_velocity());
  CHECK(kQuadratic.bounds_velocity());
  CHECK(law([](double v) { return -std::asinh(v); }).bounds_velocity());
  CHECK(law([](double v) { return -std::sinh(v); }).bounds_velocity());
  CHECK(kQuadratic.terminal_velocity(-1) == 0);
  CHECK(kQuadratic.terminal_velocity(20) == Approx(10).epsilon(1e-14));  // 10 + 0.1 100
  const auto clipped = law([](double v) { return -std::fmin(v, 2.0); });
  CHECK(clipped.terminal_velocity(2) == 2);  // the first of many
}

TEST_CASE("drag laws: the built-in ones written out agree with themselves") {
  const Drag cubic{0.7, 0.2};
  const auto written = law([](double v) { return -0.7 * v - 0.2 * v * v * v; });
  for (double v : {0.01, 0.5, 3.0}) {
    CHECK(written(v) == Approx(cubic(v)).epsilon(1e-15));
    CHECK(written.potential(v) == Approx(cubic.potential(v)).epsilon(1e-13));
    CHECK(written.terminal_velocity(v) == Approx(cubic.terminal_velocity(v)).epsilon(1e-14));
    CHECK(written.steepest(v) <= cubic.steepest(v));
    CHECK(written.steepest(v) >= 0.5 * cubic.steepest(v));
  }
  CHECK(written.slope_at_rest() == Approx(cubic.slope_at_rest()).epsilon(1e-10));
  CHECK_FALSE(written.is_linear());
  CHECK(Drag{0, 0}.is_none());
  CHECK_FALSE(law([](double) { return 0.0; }).is_none());
}

TEST_CASE("drag laws: odd or not, and what the mirror shows") {
  CHECK(kQuadratic.odd());
  CHECK(Drag{1, 2}.odd());
  const auto lopsided = law([](double v) { return v > 0 ? -v : -2 * v * (1 - v); });
  const auto mirrored = lopsided.mirrored();
  for (double u : {-2.0, -0.1, 0.3, 5.0}) {
    CHECK(mirrored(u) == -lopsided(-u));
    CHECK(mirrored.mirrored()(u) == lopsided(u));
  }
  CHECK(Drag{1, 2}.mirrored()(0.5) == Drag{1, 2}(0.5));
}

TEST_CASE("drag: coefficients too small to balance a force let it drive for ever") {
  CHECK(std::isinf(Drag{1e-310, 1e-310, {}}.terminal_velocity(1)));
  CHECK(std::isinf(Drag{1e-320, 0, {}}.terminal_velocity(1)));
}

// Differences of exp(v) - 1 lose digits as v falls: only extrapolation reaches 1e-11.
TEST_CASE("drag laws: slope at rest of a law that loses digits near 0") {
  CHECK(law([](double v) { return 1 - std::exp(v); }).slope_at_rest() == Approx(-1).epsilon(1e-11));
}

TEST_CASE("drag laws: the steepest slope is found wherever it is") {
  const auto steep = law([](double v) { return -std::tanh(1e5 * v); });
  CHECK(steep.steepest(1) >= 0.5e5);
  CHECK(steep.steepest(1) <= 1e5);
}

TEST_CASE("drag laws: the mirror of one that is not odd is not odd either") {
  auto lopsided = law([](double v) { return v > 0 ? -v : -2 * v; });
  lopsided.law_is_odd = false;
  CHECK_FALSE(lopsided.mirrored().odd());
  lopsided.reach = 7;
  CHECK(lopsided.mirrored().reach == 7);
}

TEST_CASE("terminal velocity: on the side where nothing accelerates any more, for any force") {
  for (int n = 1; n <= 2000; ++n) {
    const double force = 0.37 * n;
    for (const Drag& drag : {Drag{0.3, 0}, Drag{0, 0.7}, Drag{0.3, 0.7}}) {
      REQUIRE(force + drag(drag.terminal_velocity(force)) <= 0);
    }
  }
}
