#include <catch2/catch.hpp>
#include <cmath>

#include "stickslip/velocity/mesh.hpp"

using namespace stickslip;
using velocity::MeshRule;

namespace {

model::Process process(double mu_d, double tau, double delta, model::Drag drag) {
  return {{tau, delta, 30}, {std::max(1.0, mu_d), mu_d}, drag};
}

MeshRule rule_to(double v_max, int layers = 0) {
  MeshRule rule;
  rule.v_max = v_max;
  rule.layers = layers;
  return rule;
}

}  // namespace

TEST_CASE("mesh: rises from 0 to v_max, fine enough at 0, never too coarse above") {
  for (const auto& p : {process(0.25, 1, 0.25, {1, 0}), process(1, 1, 0.25, {0, 0}),
                        process(0.25, 1.0 / 16, 0.5, {0.01, 0}), process(0.3, 4, 0.25, {10, 2}),
                        process(1e-8, 1, 0.5, {0, 0})}) {
    const double v_max = std::min(p.drag.terminal_velocity(7), velocity::tail_velocity(p, 1e-12));
    const auto rule = rule_to(v_max);
    const auto ends = velocity::element_ends(p, rule);
    CHECK(ends.front() == 0);
    CHECK(ends.back() == v_max);
    CHECK(ends[1] <= std::max(velocity::smallest_scale(p), 0.31 * v_max) * (1 + 1e-12));
    for (std::size_t e = 1; e + 1 < ends.size(); ++e) {
      const double length = ends[e + 1] - ends[e];
      const double decay = (p.friction.mu_d - p.drag(ends[e])) * length;
      CHECK(length > 0);
      CHECK(ends[e] >= 0.29 * ends[e + 1] * (1 - 1e-12));
      CHECK(decay <= 1.31 * rule.decay);
    }
  }
}

TEST_CASE("mesh: the number of layers can be fixed, and moves only what lies near 0") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  const auto natural = velocity::element_ends(p, rule_to(7.5));
  const int layers = velocity::natural_layers(p, rule_to(7.5));
  const auto same = velocity::element_ends(p, rule_to(7.5, layers));
  const auto more = velocity::element_ends(p, rule_to(7.5, layers + 2));
  CHECK(same == natural);
  REQUIRE(more.size() == natural.size() + 2);
  CHECK(more.back() == natural.back());
  CHECK(more[more.size() - 2] == Approx(natural[natural.size() - 2]).epsilon(1e-14));
}

TEST_CASE("mesh: degrees fall by one in two layers towards v = 0, and only there") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  auto rule = rule_to(7, 8);
  CHECK(velocity::element_ends(p, rule).size() == 11);
  CHECK(velocity::element_degrees(p, rule, 9) == std::vector{6, 6, 7, 7, 8, 8, 9, 9, 9, 9});
  CHECK(velocity::element_degrees(p, rule, 4) == std::vector{2, 2, 2, 2, 3, 3, 4, 4, 4, 4});
  CHECK(velocity::element_degrees(p, rule, 1) == std::vector(10, 1));
  CHECK(velocity::element_degrees(p, rule, 0) == std::vector(10, 0));
  rule.rates.lambda = 0.9;
  CHECK(velocity::element_degrees(p, rule, 9).front() == 6);
  rule.rates.lambda = 1.1;
  CHECK(velocity::element_degrees(p, rule, 9) == std::vector(10, 9));
  rule.rates = {0, 5 * p.noise.rate()};
  const auto cut = velocity::element_ends(p, rule).size() - 1;
  CHECK(velocity::element_degrees(p, rule, 9) == std::vector(cut, 9));
}

TEST_CASE("mesh: degrees fall by two at most where bodies that leave v = 0 might turn back") {
  const auto fall = [](const model::Process& p, double leaving) {
    const auto ends = velocity::element_ends(p, rule_to(7));
    const auto degrees = velocity::element_degrees(p, rule_to(7), 9);
    int above = 0, below = 0;
    for (std::size_t e = 0; e < degrees.size(); ++e) {
      int& most = ends[e + 1] >= leaving ? above : below;
      most = std::max(most, 9 - degrees[e]);
    }
    return std::pair{above, below};
  };
  const double delta = 1.0 / 64;
  const auto leaving = [delta](double mu_d) { return 0.3 * std::pow(1 + delta - mu_d, 3); };
  for (double mu_d : {1.0, 0.9, 0.5}) {
    INFO("mu_d " << mu_d);
    const auto [above, below] = fall(process(mu_d, 1, delta, {1, 0}), leaving(mu_d));
    CHECK(above <= 2);
    CHECK(below >= (mu_d < 1 ? 3 : 0));
  }
}

TEST_CASE("mesh: a law has the elements and the tail of the coefficients it stands for") {
  const auto built_in = process(0.5, 1, 0.25, {1, 0.3});
  auto written = built_in;
  written.drag = {0, 0, [](double v) { return -v - 0.3 * v * v * v; }, 20};
  velocity::MeshRule rule;
  rule.v_max = velocity::tail_velocity(built_in, 1e-12);
  CHECK(velocity::tail_velocity(written, 1e-12) == Approx(rule.v_max).epsilon(1e-6));
  const auto ends = velocity::element_ends(built_in, rule),
             same = velocity::element_ends(written, rule);
  REQUIRE(ends.size() == same.size());
  for (std::size_t n = 0; n < ends.size(); ++n) CHECK(same[n] == Approx(ends[n]).epsilon(1e-5));
  // Drag that saturates adds to friction: the tail is exp(-(mu_d + 1) v).
  written.drag = {0, 0, [](double v) { return -std::tanh(v); }, 100};
  const double drop = std::log(1e12) + 5 + std::log(2.0);
  CHECK(velocity::tail_velocity(written, 1e-12) == Approx(drop / 1.5).epsilon(1e-4));
}

TEST_CASE("smallest scale: follows a level just below mu_d only where drag outruns the noise") {
  // On the grid: the kinetic layer 0.3 delta^3 tau^2.
  CHECK(velocity::smallest_scale(process(0.25, 1, 0.25, {1, 0})) ==
        Approx(0.3 * std::pow(0.25, 3)));
  // mu_d 1e-5 above a level, Lambda/c = 32: nothing to resolve.
  CHECK(velocity::smallest_scale(process(0.25001, 1, 0.25, {1, 0})) ==
        Approx(0.3 * std::pow(0.25, 3)));
  // The same with Lambda/c = 0.32: the scale (mu_d - x)/c.
  CHECK(velocity::smallest_scale(process(0.25001, 1, 0.25, {100, 0})) ==
        Approx(1e-7).epsilon(1e-6));
}

TEST_CASE("mesh: waves of a level next to mu_d cost few elements, however near it is") {
  for (const double gap : {1e-13, 1e-12, 1e-6, 1e-3}) {
    const auto p = process(1 + gap, 1, 1, {1, 0});
    auto rule = rule_to(1);
    const auto calm = velocity::element_ends(p, rule);
    rule.rates.omega = 1e8;
    const auto waves = velocity::element_ends(p, rule);
    CHECK(waves.size() <= calm.size() + 400);
    // Two wave lengths at 40 times the rate of the jumps, which is 2.
    CHECK(waves[1] <= 4 * 3.1416 * (p.friction.mu_d - 1) / 80);
    for (std::size_t e = 1; e < waves.size(); ++e) CHECK(waves[e] > waves[e - 1]);
  }
}

TEST_CASE("tail velocity: the white-noise bound on the density has fallen to the tolerance") {
  const auto p = process(0.5, 1, 0.25, {0.3, 0.1});
  const double v = velocity::tail_velocity(p, 1e-10);
  CHECK(0.5 * v - p.drag.potential(v) == Approx(std::log(1e10) + 5).epsilon(1e-4));
  CHECK(velocity::tail_velocity(process(0.5, 1, 0.25, {0, 0}), 1e-10) ==
        Approx((std::log(1e10) + 5) / 0.5));
}

// In white noise log-density is (g - mu_d) v + int b: the tail starts from its peak.
TEST_CASE("mesh: a bias lengthens the axis, and beyond mu_d moves the peak") {
  auto p = process(0.5, 1, 0.25, {1, 0});
  const double drop = std::log(1e12) + 5;
  for (double bias : {0.2, 0.5, 2.0, -2.0}) {
    p.bias = bias;
    const double lead = std::max(std::abs(bias) - 0.5, 0.0), slope = 0.5 - std::abs(bias);
    const double end = velocity::tail_velocity(p, 1e-12);
    CHECK(-slope * end - end * end / 2 == Approx(lead * lead / 2 - drop).epsilon(1e-4));
  }
  p.drag = {0, 0};
  p.bias = 0.3;
  CHECK(velocity::tail_velocity(p, 1e-12) == Approx(drop / 0.2));
}
