#include <cmath>
#include <stdexcept>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/linalg/dense.hpp"

using namespace stickslip;
using linalg::GaussRule;

namespace {

struct Measure {
  std::vector<double> points, weights;
};

// Far from 0 and steep: weights fall by 20 orders of magnitude.
Measure steep(int size) {
  Measure m;
  for (int i = 0; i < size; ++i) {
    m.points.push_back(7 + 3.0 * i / size);
    m.weights.push_back(1e-3 * std::exp(-46.0 * i / size));
  }
  return m;
}

double integral(const std::vector<double>& x, const std::vector<double>& w, int power) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += w[i] * std::pow((x[i] - 8.5) / 1.5, power);
  return sum;
}

}  // namespace

// Two nodes on three equal points -1, 0, 1: +-sqrt(2/3), 3/2 each.
TEST_CASE("gauss rule: two nodes for three points by hand") {
  const std::vector<double> points{-1, 0, 1}, weights{1, 1, 1};
  const GaussRule rule(points, weights, 2);
  CHECK(rule.node[0] == Approx(-std::sqrt(2.0 / 3)));
  CHECK(rule.node[1] == Approx(std::sqrt(2.0 / 3)));
  CHECK(rule.weight[0] == Approx(1.5));
  CHECK(rule.weight[1] == Approx(1.5));
  // Linear functions through the nodes.
  for (int i = 0; i < 3; ++i) {
    CHECK(rule.cardinal[2 * i + 1] == Approx(0.5 + points[i] / (2 * rule.node[1])));
    CHECK(rule.cardinal[2 * i] == Approx(0.5 - points[i] / (2 * rule.node[1])));
  }
}

TEST_CASE("gauss rule: exact up to degree 2n - 1, and no further") {
  const Measure m = steep(100);
  for (int n : {1, 2, 5, 9, 12}) {
    const GaussRule rule(m.points, m.weights, n);
    for (int power = 0; power < 2 * n; ++power) {
      const double exact = integral(m.points, m.weights, power);
      CHECK(integral(rule.node, rule.weight, power) == Approx(exact).epsilon(1e-12));
    }
    if (n > 2) continue;
    const double beyond = integral(m.points, m.weights, 2 * n);
    CHECK(std::abs(integral(rule.node, rule.weight, 2 * n) / beyond - 1) > 1e-9);
  }
}

TEST_CASE("gauss rule: cardinal functions are orthogonal, interpolate and sum to one") {
  const Measure m = steep(60);
  const int n = 8;
  const GaussRule rule(m.points, m.weights, n);
  for (int l = 0; l < n; ++l) {
    for (int k = 0; k < n; ++k) {
      double product = 0;
      for (std::size_t i = 0; i < m.points.size(); ++i) {
        product += m.weights[i] * rule.cardinal[i * n + l] * rule.cardinal[i * n + k];
      }
      const double size = std::sqrt(rule.weight[l] * rule.weight[k]);
      CHECK(std::abs(product - (l == k ? rule.weight[l] : 0)) < 1e-13 * size);
    }
  }
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    double sum = 0, cube = 0, size = 0;
    for (int l = 0; l < n; ++l) {
      const double value = rule.cardinal[i * n + l];
      sum += value;
      cube += value * std::pow(rule.node[l], 3);
      size += std::abs(value);
    }
    CHECK(std::abs(sum - 1) < 1e-13 * size);
    CHECK(std::abs(cube / std::pow(m.points[i], 3) - 1) < 1e-13 * size);
  }
}

// Where points are dense, differences of the values themselves keep few digits.
TEST_CASE("gauss rule: steps are differences of the cardinal functions with digits of their own") {
  const int size = 20000, n = 7;
  const Measure m = steep(size);
  const GaussRule rule(m.points, m.weights, n);
  for (int i = 0; i + 1 < size; i += 997) {
    double slope = 0, sum = 0, largest = 0;
    for (int l = 0; l < n; ++l) {
      const double step = rule.step[i * n + l];
      const double difference = rule.cardinal[(i + 1) * n + l] - rule.cardinal[i * n + l];
      double scale = 0;
      for (int k = 0; k < n; ++k) scale += std::abs(rule.cardinal[i * n + k]);
      CHECK(std::abs(step - difference) < 1e-13 * scale);
      slope += step * rule.node[l];
      sum += step;
      largest = std::max(largest, std::abs(step));
    }
    // Interpolation of x is x, of 1 is 1: to rounding of the steps, not of the values.
    const double exact = m.points[i + 1] - m.points[i];
    CHECK(std::abs(sum) < 1e-11 * largest);
    CHECK(std::abs(slope - exact) < 1e-11 * largest * m.points[i]);
  }
}

TEST_CASE("gauss rule: as many nodes as points are none") {
  const std::vector<double> three{1, 2, 3};
  CHECK_THROWS_AS(GaussRule(three, three, 3), std::invalid_argument);
  CHECK_THROWS_AS(GaussRule(three, three, 0), std::invalid_argument);
}
