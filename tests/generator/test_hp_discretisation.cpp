#include <cmath>
#include <functional>
#include <numeric>

#include "../common/catch.hpp"
#include "stickslip/generator/velocity_methods.hpp"

using namespace stickslip;
using generator::HpDiscretisation;
using generator::ReferenceElement;

namespace {

double power(double x, int n) { return n == 0 ? 1 : std::pow(x, n); }

// (T u)_j with the diagonal that makes T 1 = 0.
double apply_row(const generator::TransportRow& row, int j, const std::vector<double>& u,
                 double at_rest, double at_top) {
  double sum = row.inflow * (at_rest - u[j]) + row.outflow * (at_top - u[j]);
  for (const auto& e : row.entries) sum += e.value * (u[e.node] - u[j]);
  return sum;
}

}  // namespace

TEST_CASE("reference element: quadrature is exact up to degree 2q - 1") {
  for (int degree : {0, 1, 2, 5, 9, 16, 24}) {
    const ReferenceElement r(degree);
    REQUIRE(r.size == degree + 1);
    for (int n = 0; n <= 2 * degree + 1; ++n) {
      double sum = 0;
      for (int m = 0; m < r.size; ++m) sum += r.weight[m] * power(r.node[m], n);
      CHECK(sum == Approx(1.0 / (n + 1)).epsilon(1e-13));
    }
  }
}

TEST_CASE("reference element: basis, end values and integrals reproduce polynomials") {
  const ReferenceElement r(6);
  const auto polynomial = [](double t) { return 1 - 3 * t + power(t, 4) - 2 * power(t, 6); };
  const auto primitive = [](double t) {
    return t - 1.5 * t * t + power(t, 5) / 5 - 2 * power(t, 7) / 7;
  };
  const auto combine = [&](const std::vector<double>& coefficients) {
    double sum = 0;
    for (int n = 0; n < r.size; ++n) sum += coefficients[n] * polynomial(r.node[n]);
    return sum;
  };
  CHECK(combine(r.at_left) == Approx(polynomial(0)).epsilon(1e-13));
  CHECK(combine(r.at_right) == Approx(polynomial(1)).epsilon(1e-13));
  for (double t : {0.0, 0.13, 0.5, 0.77, 1.0}) {
    CHECK(combine(r.basis(t)) == Approx(polynomial(t)).epsilon(1e-12));
    CHECK(combine(r.integral(t)) == Approx(primitive(t)).epsilon(1e-12).margin(1e-14));
  }
  CHECK(combine(r.basis(r.node[2])) == polynomial(r.node[2]));
}

// For u a polynomial the jumps vanish and T u = B u' at the nodes, whichever way the flow goes.
TEST_CASE("hp transport: exact on polynomials of the lowest degree of an element") {
  const model::Drag drag{1, 0.3};
  const HpDiscretisation velocities({0, 0.05, 0.2, 0.7, 2}, {4, 6, 4, 9}, drag);
  const auto u = [](double v) { return 2 - v + 3 * v * v - power(v, 4); };
  const auto slope = [](double v) { return -1 + 6 * v - 4 * power(v, 3); };
  std::vector<double> values;
  for (double v : velocities.nodes()) values.push_back(u(v));
  generator::TransportRow row;
  for (double net_force : {-3.0, -0.1, 0.0, 0.4, 1.7, 9.0}) {
    for (int j = 0; j < velocities.size(); ++j) {
      velocities.transport(net_force, j, row);
      const double v = velocities.nodes()[j];
      const double expected = (net_force + drag(v)) * slope(v);
      CHECK(apply_row(row, j, values, u(0), u(2)) == Approx(expected).margin(1e-10));
    }
  }
}

TEST_CASE("hp transport: meets rest only where the flow reaches it, the top likewise") {
  const HpDiscretisation velocities({0, 0.5, 1}, 3, model::Drag{1, 0});
  const auto largest = [&](double net_force, double generator::TransportRow::*coefficient) {
    generator::TransportRow row;
    double size = 0;
    for (int j = 0; j < velocities.size(); ++j) {
      velocities.transport(net_force, j, row);
      size = std::max(size, std::abs(row.*coefficient));
    }
    return size;
  };
  CHECK(largest(0.25, &generator::TransportRow::inflow) == 0);
  CHECK(largest(0.25, &generator::TransportRow::outflow) == 0);
  CHECK(largest(-0.25, &generator::TransportRow::inflow) > 0);
  CHECK(largest(1.25, &generator::TransportRow::outflow) > 0);
  // A level at mu_d creeps towards rest and never arrives.
  CHECK(largest(0, &generator::TransportRow::inflow) == 0);
}

TEST_CASE("hp discretisation: traces extrapolate, weights integrate, masses accumulate") {
  const HpDiscretisation velocities({0, 0.1, 1, 3}, {2, 3, 5}, model::Drag{1, 0});
  std::vector<double> mass;
  double integral = 0, at_zero = 0, at_top = 0;
  const auto density = [](double v) { return 1 + v * v; };
  for (int j = 0; j < velocities.size(); ++j) {
    mass.push_back(velocities.weights()[j] * density(velocities.nodes()[j]));
    integral += mass.back();
  }
  for (const auto& e : velocities.trace_at_zero())
    at_zero += e.value * density(velocities.nodes()[e.node]);
  for (const auto& e : velocities.trace_at_top())
    at_top += e.value * density(velocities.nodes()[e.node]);
  CHECK(integral == Approx(12).epsilon(1e-14));
  CHECK(at_zero == Approx(1).epsilon(1e-12));
  CHECK(at_top == Approx(10).epsilon(1e-12));
  for (double v : {0.0, 0.04, 0.1, 0.5, 1.0, 2.9, 3.0}) {
    CHECK(velocities.mass_below(mass, v) == Approx(v + v * v * v / 3).epsilon(1e-12).margin(1e-15));
  }
}

TEST_CASE("hp discretisation: refuses elements that do not rise from 0") {
  CHECK_THROWS_AS(HpDiscretisation({0}, 2, model::Drag{}), std::invalid_argument);
  CHECK_THROWS_AS(HpDiscretisation({0.1, 1}, 2, model::Drag{}), std::invalid_argument);
  CHECK_THROWS_AS(HpDiscretisation({0, 2, 1}, 2, model::Drag{}), std::invalid_argument);
  CHECK_THROWS_AS(HpDiscretisation({0, 1}, -1, model::Drag{}), std::invalid_argument);
  CHECK_THROWS_AS(HpDiscretisation({0, 1, 2}, std::vector{3}, model::Drag{}),
                  std::invalid_argument);
}

TEST_CASE(
    "hp discretisation: values are exact on polynomials of its degree, ends of elements included") {
  const std::vector<double> ends{0, 1e-6, 0.01, 0.5, 3};
  for (int degree : {0, 1, 4, 9}) {
    const HpDiscretisation velocities(ends, degree, model::Drag{1, 0});
    std::vector<double> places{1e-300, 1e-12, 3e-7, 0.007, 0.123, 2.9, std::nextafter(3.0, 0.0)};
    places.insert(places.end(), ends.begin() + 1, ends.end());
    places.push_back(velocities.nodes()[degree]);
    for (double v : places) {
      for (int n = 0; n <= degree; ++n) {
        double sum = 0, terms = 0;  // rounding is that of the terms
        for (const auto& e : velocities.value_at(v)) {
          const double term = e.value * power(velocities.nodes()[e.node], n);
          sum += term;
          terms += std::abs(term);
        }
        INFO("degree " << degree << " power " << n << " v " << v);
        CHECK(std::abs(sum - power(v, n)) <= 1e-14 * terms);
      }
    }
  }
}

TEST_CASE("hp discretisation: a value takes the nodes of its own element, a node itself") {
  const std::vector<double> ends{0, 0.1, 1, 3};
  const HpDiscretisation velocities(ends, 3, model::Drag{1, 0});
  for (double v : {0.05, 0.6, 1.7, 3.0}) {
    const auto value = velocities.value_at(v);
    REQUIRE(value.size() == 4);
    const int element = value.front().node / 4;
    CHECK(ends[element] < v);
    CHECK(v <= ends[element + 1]);
    for (int n = 0; n < 4; ++n) CHECK(value[n].node == 4 * element + n);
  }
  for (const auto& e : velocities.value_at(velocities.nodes()[6])) {
    CHECK(e.value == Approx(e.node == 6 ? 1 : 0).margin(1e-12));
  }
}

// B + h dB with dB = 1 + 0.5 v is the row of net_force + h and drag -(1 - 0.5 h) v.
TEST_CASE("hp transport: the derivative of a row is the difference of rows") {
  const double h = 1e-6;
  const std::vector<double> ends{0, 0.5, 1.5};
  const auto velocities = [&](double by) { return HpDiscretisation(ends, 3, {1 - 0.5 * by, 0}); };
  const HpDiscretisation here = velocities(0), more = velocities(h), less = velocities(-h);
  generator::TransportRow row, plus, minus;
  for (double net_force : {-0.7, 0.2, 0.9, 2.0}) {
    for (int j = 0; j < here.size(); ++j) {
      here.transport_change(
          net_force, [](double v) { return 1 + 0.5 * v; }, j, row);
      more.transport(net_force + h, j, plus);
      less.transport(net_force - h, j, minus);
      std::vector<double> change(here.size(), 0.0);
      for (const auto& e : plus.entries) change[e.node] += e.value / (2 * h);
      for (const auto& e : minus.entries) change[e.node] -= e.value / (2 * h);
      for (const auto& e : row.entries) change[e.node] -= e.value;
      for (double left : change) CHECK(std::abs(left) < 1e-7);
      CHECK(row.inflow == Approx((plus.inflow - minus.inflow) / (2 * h)).margin(1e-7));
      CHECK(row.outflow == Approx((plus.outflow - minus.outflow) / (2 * h)).margin(1e-7));
    }
  }
}

TEST_CASE("hp discretisation: what sums over nodes overlook is nothing for polynomials, and a "
          "jump's error") {
  const HpDiscretisation hp({0, 0.5, 2}, std::vector{3, 5}, {});
  for (int n = 0; n <= 3; ++n) {
    for (double d : hp.overlooked([n](double v) { return power(v, n); })) {
      CHECK(std::abs(d) < 1e-13);
    }
  }
  const auto sum = [&hp](const std::vector<double>& values) {
    return std::inner_product(values.begin(), values.end(), hp.weights().begin(), 0.0);
  };
  // Summed with the weights: 13 points against 6.
  const auto smooth = [](double v) { return power(v, 13); };
  double seen = 0;
  for (int j = 0; j < hp.size(); ++j) seen += hp.weights()[j] * smooth(hp.nodes()[j]);
  CHECK(sum(hp.overlooked(smooth)) == Approx(power(2, 14) / 14 - seen).epsilon(1e-5));
  // At no place of a jump both rules agree unless both are right.
  for (double at = 0.6; at < 2; at += 0.01) {
    const auto jump = [at](double v) { return v > at ? 1.0 : 0.0; };
    double by_nodes = 0;
    for (int j = 0; j < hp.size(); ++j) by_nodes += hp.weights()[j] * jump(hp.nodes()[j]);
    const double wrong = std::abs(by_nodes - (2 - at));
    if (wrong > 0.15) CHECK(std::abs(sum(hp.overlooked(jump))) > 0.3 * wrong);
  }
}
