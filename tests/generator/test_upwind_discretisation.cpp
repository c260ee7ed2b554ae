#include <cmath>
#include <numeric>

#include "../common/catch.hpp"
#include "stickslip/generator/velocity_methods.hpp"

using namespace stickslip;
using generator::UpwindDiscretisation;

TEST_CASE("upwind transport: rates are >= 0 and go with the flow") {
  const UpwindDiscretisation velocities(0.1, 20, model::Drag{1, 0});
  generator::TransportRow row;
  for (double net_force : {-0.55, 0.55, 3.0}) {
    for (int j = 0; j < velocities.size(); ++j) {
      velocities.transport(net_force, j, row);
      const double speed = net_force - velocities.nodes()[j];
      const bool last = j == velocities.size() - 1, first = j == 0;
      const double expected = std::abs(speed) / 0.1;
      CHECK(row.outflow == 0);
      if (speed < 0 && first) {
        CHECK(row.inflow == Approx(expected));
        CHECK(row.entries.empty());
      } else if (speed > 0 && last) {
        CHECK(row.entries.empty());  // the last node holds what still accelerates
      } else {
        REQUIRE(row.entries.size() == 1);
        CHECK(row.entries[0].node == (speed < 0 ? j - 1 : j + 1));
        CHECK(row.entries[0].value == Approx(expected));
        CHECK(row.inflow == 0);
      }
    }
  }
}

TEST_CASE("upwind discretisation: a state at the origin moves on at speed over spacing") {
  const UpwindDiscretisation velocities(0.5, 4, model::Drag{1, 0});
  CHECK(velocities.keeps_origin());
  CHECK_FALSE(velocities.needs_holding());
  CHECK(velocities.origin_rate(0.75) == 1.5);
}

TEST_CASE("upwind discretisation: cells share the mass of their nodes") {
  const UpwindDiscretisation velocities(1, 3, model::Drag{1, 0});
  const std::vector<double> mass{0.2, 0.3, 0.5};
  CHECK(velocities.mass_below(mass, 0.5) == 0);
  CHECK(velocities.mass_below(mass, 1) == Approx(0.1));
  CHECK(velocities.mass_below(mass, 1.5) == Approx(0.2));
  CHECK(velocities.mass_below(mass, 3.5) == Approx(1));
}

TEST_CASE("upwind discretisation: refuses to have no nodes") {
  CHECK_THROWS_AS(UpwindDiscretisation(0, 3, model::Drag{}), std::invalid_argument);
  CHECK_THROWS_AS(UpwindDiscretisation(1, 0, model::Drag{}), std::invalid_argument);
}

TEST_CASE("upwind discretisation: values are exact on linear functions between nodes") {
  const UpwindDiscretisation velocities(0.1, 20, model::Drag{1, 0});
  for (double v : {0.1, 0.1 + 1e-13, 0.17, 0.2, 1.999, std::nextafter(2.0, 0.0), 2.0}) {
    double constant = 0, linear = 0;
    for (const auto& e : velocities.value_at(v)) {
      CHECK(std::abs(velocities.nodes()[e.node] - v) < 0.1 + 1e-12);
      constant += e.value;
      linear += e.value * velocities.nodes()[e.node];
    }
    CHECK(constant == Approx(1).epsilon(1e-15));
    CHECK(linear == Approx(v).epsilon(1e-14));
  }
}

// The cell around v = 0 has a state of its own only on some levels.
TEST_CASE("upwind discretisation: below the first node, its value") {
  for (int count : {1, 2, 20}) {
    const UpwindDiscretisation velocities(0.1, count, model::Drag{1, 0});
    for (double v : {1e-300, 0.01, 0.0999}) {
      double first = 0;
      for (const auto& e : velocities.value_at(v)) first += e.node == 0 ? e.value : 0 * e.value;
      CHECK(first == 1);
    }
  }
  const UpwindDiscretisation one(0.1, 1, model::Drag{1, 0});
  REQUIRE(one.value_at(0.1).size() == 1);
  CHECK(one.value_at(0.1)[0].value == 1);
}

// B + h dB with dB = 1 + 0.5 v is the row of net_force + h and drag -(1 - 0.5 h) v.
TEST_CASE("upwind transport: the derivative of a row is the difference of rows") {
  const double h = 1e-6;
  const UpwindDiscretisation velocities(0.1, 20, model::Drag{1, 0}),
      more(0.1, 20, model::Drag{1 - 0.5 * h, 0});
  generator::TransportRow row, here, changed;
  for (double net_force : {-0.55, 0.55, 3.0}) {
    for (int j = 0; j < velocities.size(); ++j) {
      velocities.transport_change(
          net_force, [](double v) { return 1 + 0.5 * v; }, j, row);
      velocities.transport(net_force, j, here);
      more.transport(net_force + h, j, changed);
      REQUIRE(row.entries.size() == here.entries.size());
      for (std::size_t n = 0; n < row.entries.size(); ++n) {
        CHECK(row.entries[n].node == here.entries[n].node);
        const double change = changed.entries[n].value - here.entries[n].value;
        CHECK(row.entries[n].value == Approx(change / h).epsilon(1e-6));
      }
      CHECK(row.inflow == Approx((changed.inflow - here.inflow) / h).epsilon(1e-6));
    }
  }
  // Also where a speed falls that is upwards.
  velocities.transport_change(
      3, [](double) { return -1.0; }, 2, row);
  REQUIRE(row.entries.size() == 1);
  CHECK(row.entries[0].node == 3);
  CHECK(row.entries[0].value == Approx(-10));
}

TEST_CASE("upwind discretisation: cells lie around the nodes") {
  const UpwindDiscretisation velocities(0.5, 3, model::Drag{1, 0});
  const auto cells = velocities.cells();
  CHECK(std::vector(cells.begin(), cells.end()) == std::vector<double>{0, 0.75, 1.25, 1.75});
}
