#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/generator/velocity_mesh.hpp"

using namespace stickslip;
using generator::MeshRule;

namespace {

model::Process process(double mu_d, double tau, double delta, model::Drag drag) {
  const int beyond_rest = 30 + static_cast<int>(std::max(1.0, mu_d) / delta);
  return {{tau, delta, beyond_rest}, {std::max(1.0, mu_d), mu_d}, drag};
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
    const double v_max = std::min(p.drag.terminal_velocity(7), generator::tail_velocity(p, 1e-12));
    const auto rule = rule_to(v_max);
    const auto ends = generator::element_ends(p, rule);
    CHECK(ends.front() == 0);
    CHECK(ends.back() == v_max);
    CHECK(ends[1] <= std::max(generator::smallest_scale(p), 0.31 * v_max) * (1 + 1e-12));
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
  const auto natural = generator::element_ends(p, rule_to(7.5));
  const int layers = generator::natural_layers(p, rule_to(7.5));
  const auto same = generator::element_ends(p, rule_to(7.5, layers));
  const auto more = generator::element_ends(p, rule_to(7.5, layers + 2));
  CHECK(same == natural);
  REQUIRE(more.size() == natural.size() + 2);
  CHECK(more.back() == natural.back());
  CHECK(more[more.size() - 2] == Approx(natural[natural.size() - 2]).epsilon(1e-14));
}

TEST_CASE("mesh: degrees fall by one in two layers towards v = 0, and only there") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  auto rule = rule_to(7, 8);
  rule.whole_tail = true;
  CHECK(generator::element_ends(p, rule).size() == 11);
  CHECK(generator::element_degrees(p, rule, 9) == std::vector{6, 6, 7, 7, 8, 8, 9, 9, 9, 9});
  CHECK(generator::element_degrees(p, rule, 4) == std::vector{2, 2, 2, 2, 3, 3, 4, 4, 4, 4});
  CHECK(generator::element_degrees(p, rule, 1) == std::vector(10, 1));
  rule.least_degree = 0;
  CHECK(generator::element_degrees(p, rule, 3) == std::vector{0, 0, 1, 1, 2, 2, 3, 3, 3, 3});
  CHECK(generator::element_degrees(p, rule, 0) == std::vector(10, 0));
  rule.rates.lambda = 0.9;
  CHECK(generator::element_degrees(p, rule, 9).front() == 6);
  rule.rates.lambda = 1.1;
  CHECK(generator::element_degrees(p, rule, 9) == std::vector(10, 9));
  rule.rates = {0, 5 * p.noise.rate()};
  const auto elements = generator::element_ends(p, rule).size() - 1;
  CHECK(generator::element_degrees(p, rule, 9) == std::vector(elements, 9));
}

TEST_CASE("mesh: elements for path lengths halve towards v = 0, degrees fall by one in three") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  auto rule = rule_to(7, 8);
  rule.whole_tail = true;
  rule.rates.lengths = true;
  const auto ends = generator::element_ends(p, rule);
  for (int e = 1; e < 8; ++e) CHECK(ends[e] == Approx(ends[e + 1] / 2).epsilon(1e-14));
  const auto degrees = generator::element_degrees(p, rule, 9);
  const std::vector graded(degrees.begin(), degrees.begin() + 8);
  CHECK(graded == std::vector{7, 7, 8, 8, 8, 9, 9, 9});
  rule.layers = 0;
  const int fine = generator::natural_layers(p, rule);
  rule.rates.lengths = false;
  CHECK(fine > 1.5 * generator::natural_layers(p, rule));
}

// Without drag the density is exp(-mu_d v/D), D = 2/tau: a digit each ln(10) D/mu_d.
TEST_CASE("mesh: degrees fall by a half for each digit that the density is below 1e-3") {
  const auto p = process(0.5, 1, 0.25, {0, 0});
  auto rule = rule_to(generator::tail_velocity(p, 1e-14));
  rule.least_degree = 3;
  const auto ends = generator::element_ends(p, rule);
  const auto degrees = generator::element_degrees(p, rule, 9);
  rule.whole_tail = true;
  const auto whole = generator::element_degrees(p, rule, 9);
  const double digit = std::log(10) * p.noise.intensity() / p.friction.mu_d;
  int lowered = 0;
  for (std::size_t e = 0; e < degrees.size(); ++e) {
    const int less = std::max(0, static_cast<int>((ends[e] / digit - 3) / 2));
    CHECK(degrees[e] == std::max(5, whole[e] - less));
    lowered += degrees[e] < whole[e] ? 1 : 0;
  }
  CHECK(degrees.back() == 5);
  CHECK(lowered > 1);
  rule.whole_tail = false;
  CHECK(generator::element_degrees(p, rule, 3).back() == 3);
}

TEST_CASE("mesh: degrees fall by two at most where bodies that leave v = 0 might turn back") {
  const auto fall = [](const model::Process& p, double leaving) {
    const auto ends = generator::element_ends(p, rule_to(7));
    auto rule = rule_to(7);
    rule.whole_tail = true;
    const auto degrees = generator::element_degrees(p, rule, 9);
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

TEST_CASE("mesh: a drag law has the elements and the tail of the coefficients it stands for") {
  const auto built_in = process(0.5, 1, 0.25, {1, 0.3});
  auto written = built_in;
  written.drag = {0, 0, [](double v) { return -v - 0.3 * v * v * v; }, 20};
  generator::MeshRule rule;
  rule.v_max = generator::tail_velocity(built_in, 1e-12);
  CHECK(generator::tail_velocity(written, 1e-12) == Approx(rule.v_max).epsilon(1e-6));
  const auto ends = generator::element_ends(built_in, rule),
             same = generator::element_ends(written, rule);
  REQUIRE(ends.size() == same.size());
  for (std::size_t n = 0; n < ends.size(); ++n) CHECK(same[n] == Approx(ends[n]).epsilon(1e-5));
  // Drag that saturates adds to friction: the tail is exp(-(mu_d + 1) v).
  written.drag = {0, 0, [](double v) { return -std::tanh(v); }, 100};
  const double drop = std::log(1e12) + 5 + std::log(2.0);
  CHECK(generator::tail_velocity(written, 1e-12) == Approx(drop / 1.5).epsilon(1e-4));
}

TEST_CASE("smallest scale: follows a level just below mu_d only where drag outruns the noise") {
  // On the grid: the kinetic layer 0.3 delta^3 tau^2.
  CHECK(generator::smallest_scale(process(0.25, 1, 0.25, {1, 0})) ==
        Approx(0.3 * std::pow(0.25, 3)));
  // mu_d 1e-5 above a level, Lambda/c = 32: nothing to resolve.
  CHECK(generator::smallest_scale(process(0.25001, 1, 0.25, {1, 0})) ==
        Approx(0.3 * std::pow(0.25, 3)));
  // The same with Lambda/c = 0.32: the scale (mu_d - x)/c.
  CHECK(generator::smallest_scale(process(0.25001, 1, 0.25, {100, 0})) ==
        Approx(1e-7).epsilon(1e-6));
}

TEST_CASE("mesh: waves of a level next to mu_d cost few elements, however near it is") {
  for (const double gap : {1e-13, 1e-12, 1e-6, 1e-3}) {
    const auto p = process(1 + gap, 1, 1, {1, 0});
    auto rule = rule_to(1);
    const auto calm = generator::element_ends(p, rule);
    rule.rates.omega = 80;
    const auto waves = generator::element_ends(p, rule);
    CHECK(waves.size() <= calm.size() + 400);
    // Two wave lengths.
    CHECK(waves[1] <= 4 * 3.1416 * (p.friction.mu_d - 1) / 80);
    for (std::size_t e = 1; e < waves.size(); ++e) CHECK(waves[e] > waves[e - 1]);
  }
}

TEST_CASE("tail velocity: the white-noise bound on the density has fallen to the tolerance") {
  const auto p = process(0.5, 1, 0.25, {0.3, 0.1});
  const double v = generator::tail_velocity(p, 1e-10);
  CHECK(0.5 * v - p.drag.potential(v) == Approx(std::log(1e10) + 5).epsilon(1e-4));
  CHECK(generator::tail_velocity(process(0.5, 1, 0.25, {0, 0}), 1e-10) ==
        Approx((std::log(1e10) + 5) / 0.5));
}

// In white noise log-density is (g - mu_d) v + int b: the tail starts from its peak.
TEST_CASE("mesh: a bias raises the truncation velocity, and beyond mu_d moves the peak") {
  auto p = process(0.5, 1, 0.25, {1, 0});
  const double drop = std::log(1e12) + 5;
  for (double bias : {0.2, 0.5, 2.0, -2.0}) {
    p.bias = bias;
    const double lead = std::max(std::abs(bias) - 0.5, 0.0), slope = 0.5 - std::abs(bias);
    const double end = generator::tail_velocity(p, 1e-12);
    CHECK(-slope * end - end * end / 2 == Approx(lead * lead / 2 - drop).epsilon(1e-4));
  }
  p.drag = {0, 0};
  p.bias = 0.3;
  CHECK(generator::tail_velocity(p, 1e-12) == Approx(drop / 0.2));
}

namespace {

model::Process with_bias(model::Process p, double bias) {
  p.bias = bias;
  return p;
}

// Drag three times as large downwards.
model::Drag one_sided() {
  model::Drag drag{0, 0, [](double v) { return v > 0 ? -v : -3 * v; }, 100};
  drag.law_is_odd = false;
  return drag;
}

}  // namespace

TEST_CASE("mesh: elements serve both signs of v, with the bias against or along") {
  for (const auto& p :
       {with_bias(process(0.25, 1, 0.25, {1, 0}), 2.0),
        with_bias(process(0.25, 1, 0.25, {0.1, 0}), -1.0), process(0.25, 1, 0.25, one_sided())}) {
    const auto rule = rule_to(20);
    const auto ends = generator::element_ends(p, rule);
    for (std::size_t e = 1; e + 1 < ends.size(); ++e) {
      const double drag = std::max(-p.drag(ends[e]), p.drag(-ends[e]));
      const double rate = p.friction.mu_d + std::abs(p.bias) + drag;
      CHECK(rate * (ends[e + 1] - ends[e]) <= 1.31 * rule.decay);
    }
  }
}

TEST_CASE("mesh: no last element is a sliver") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  for (double v_max = 5; v_max < 12; v_max += 0.1) {
    const auto ends = generator::element_ends(p, rule_to(v_max));
    const double before = ends[ends.size() - 2];
    const double step = 8 / (0.25 + ends[ends.size() - 3]);
    INFO("v_max " << v_max);
    CHECK(v_max - before >= 0.29 * std::min(step, before));
  }
}

TEST_CASE("mesh: the first element is as small as the smallest scale, and no layer is wasted") {
  for (const auto& p : {process(0.25, 1, 0.25, {1, 0}), process(0.5, 2, 0.125, {1, 0}),
                        process(0.9, 0.5, 0.25, {0, 1})}) {
    for (double lambda : {0.0, 100.0}) {
      auto rule = rule_to(7);
      rule.rates.lambda = lambda;
      const double scale = generator::smallest_scale(p, lambda);
      const double first = generator::element_ends(p, rule)[1];
      CHECK(first <= scale * (1 + 1e-12));
      CHECK(first > 0.3 * scale * (1 - 1e-12));
    }
  }
}

TEST_CASE("mesh: below the speed of leaving, degrees fall by one in two elements beyond two") {
  const auto p = process(0.9, 1, 1.0 / 64, {1, 0});
  const auto rule = rule_to(7, 14);
  const auto ends = generator::element_ends(p, rule);
  const double leaving = 0.3 * std::pow(0.1 + 1.0 / 64, 3);
  REQUIRE(ends[7] < leaving);
  REQUIRE(ends[8] > leaving);
  const std::vector expected{7, 7, 8, 8, 9, 9, 10, 10, 10, 10, 11, 11, 12, 12};
  auto degrees = generator::element_degrees(p, rule, 12);
  degrees.resize(14);
  CHECK(degrees == expected);
  // A bias brings one of the two sides nearer to the edge of rest.
  const auto coarse = process(0.9, 1, 0.25, {1, 0});
  CHECK(generator::element_degrees(with_bias(coarse, 0.01), rule, 12) ==
        generator::element_degrees(with_bias(coarse, -0.01), rule, 12));
}

// Lambda = 32/tau^2 at delta = 1/4.
TEST_CASE("smallest scale: the kinetic layer grows with tau, resting ones fall with lambda") {
  CHECK(generator::smallest_scale(process(0.25, 2, 0.25, {1, 0})) ==
        Approx(0.3 * std::pow(0.25, 3) * 4));
  // A level 1e-3 below mu_d, drag 10: (1 + v/s)^(-3.2) is seen from the kinetic layer on.
  CHECK(generator::smallest_scale(process(0.251, 1, 0.25, {10, 0})) == Approx(1e-4));
  // On the grid the nearest level is delta below mu_d.
  const auto on_grid = process(0.25, 1, 0.25, {1, 0});
  CHECK(generator::smallest_scale(on_grid, 100) == Approx(0.25 / (32 + 100)));
  CHECK(generator::smallest_scale(on_grid, 1e-3) == generator::smallest_scale(on_grid));
  // Near a level its share counts from (lambda/Lambda)(gap/delta) = 1e-3 on.
  const auto near = process(0.2525, 1, 0.25, {0, 0});
  CHECK(generator::smallest_scale(near, 4) == Approx(0.0025 / 36));
  CHECK(generator::smallest_scale(near, 100) == Approx(0.0025 / 132));
  CHECK(generator::smallest_scale(near, 3) == generator::smallest_scale(near));
}

TEST_CASE("smallest scale: of two velocity branches the finer one") {
  for (double bias : {0.1, -0.1}) {
    // Levels below mu_d -+ bias: 0.2 below 0.2, and 0.15 below 0.4.
    const auto p = with_bias(process(0.3, 1, 0.25, {1, 0}), bias);
    CHECK(generator::smallest_scale(p, 1e4) == Approx(0.15 / 10032));
  }
}

// On a level a below mu_d waves are 2 pi a/omega long, and none is left at v = 20 a/Lambda.
TEST_CASE("mesh: every element has two waves at most, and none is split in vain") {
  const auto p = process(0.3, 1, 0.25, {1, 0});
  const double rate = p.noise.rate(), gap = 0.05;
  for (double omega : {5 * rate, 20 * rate, 1000 * rate}) {
    auto rule = rule_to(3);
    const auto calm = generator::element_ends(p, rule);
    rule.rates.omega = omega;
    const auto waves = generator::element_ends(p, rule);
    const auto widest = [&](double v) {
      const double distance = v < 20 * gap / rate ? gap : std::max(gap + 0.25, rate * v / 20);
      return 4 * std::acos(-1.0) * distance / std::min(omega, 40 * rate);
    };
    REQUIRE(calm[1] < 20 * gap / rate);
    std::size_t count = 1;
    for (std::size_t e = 1; e < calm.size(); ++e) {
      const double pieces = (calm[e] - calm[e - 1]) / widest(calm[e - 1]);
      count += static_cast<std::size_t>(std::ceil(pieces - 1e-9));
    }
    CHECK(waves.size() == count);
    for (double end : calm) CHECK(std::count(waves.begin(), waves.end(), end) == 1);
  }
}

// Widths are those that both branches need. Levels of a table have other numbers when mirrored.
TEST_CASE("mesh: elements follow waves of a lopsided table on both branches alike") {
  auto p = process(0.026, 1, 0.25, {0.1, 0});
  p.noise.table = std::make_shared<const model::LevelTable>(
      std::vector<model::Level>{{-0.7, 0.8, 0}, {1, 0.2, 0.1}, {1.7, 0.9, 0.4}, {3, 0, 0.1}});
  REQUIRE(p.noise.lowest() != -p.noise.highest());
  auto rule = rule_to(16);
  for (double omega : {4.0, 25.0, 100.0}) {
    rule.rates.omega = omega;
    REQUIRE(generator::has_waves(p, omega));
    const auto ends = generator::element_ends(p, rule);
    CHECK((generator::element_ends(p.mirrored(), rule) == ends));
  }
}

TEST_CASE(
    "tail velocity: that of the branch with the longer tail, and no further than a drag law") {
  for (double bias : {0.2, -0.2}) {
    auto p = with_bias(process(0.5, 1, 0.25, {0, 0}), bias);
    CHECK(generator::tail_velocity(p, 1e-10) == Approx((std::log(1e10) + 5) / 0.3));
  }
  auto p = process(0.5, 1, 0.25, one_sided());
  const double drop = std::log(1e10) + 5, v = generator::tail_velocity(p, 1e-10);
  CHECK(0.5 * v + v * v / 2 == Approx(drop).epsilon(1e-4));
  p.bias = 0.3;  // along the weaker drag
  const double longer = generator::tail_velocity(p, 1e-10);
  CHECK(0.2 * longer + longer * longer / 2 == Approx(drop).epsilon(1e-4));
  p.drag.reach = 2;
  CHECK(generator::tail_velocity(p, 1e-10) == 2);
}

TEST_CASE("tail velocity: at its end the density is below the tolerance, not above") {
  for (double mu_d : {0.3, 0.5, 0.9}) {
    const auto p = process(mu_d, 1, 0.25, {0.3, 0.1});
    const double v = generator::tail_velocity(p, 1e-10);
    CHECK(mu_d * v - p.drag.potential(v) >= (std::log(1e10) + 5) * (1 - 1e-15));
  }
}

namespace {

std::vector<double> with_law(std::function<double(double)> law, std::vector<double> breaks = {}) {
  model::Drag drag{0, 0, std::move(law), 100, true, std::move(breaks)};
  return generator::element_ends(process(0.25, 1, 0.25, drag), rule_to(7));
}

bool has(const std::vector<double>& ends, double v) {
  return std::find(ends.begin(), ends.end(), v) != ends.end();
}

}  // namespace

TEST_CASE("mesh: smooth drag laws and polynomials leave the elements as they are") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  const auto plain = generator::element_ends(p, rule_to(7));
  CHECK(with_law([](double v) { return -v; }) == plain);
  auto rule = rule_to(7);
  for (int n = 0; n <= 6; ++n) {
    rule.integrands.functions.emplace_back([n](double v) { return std::pow(v, n); });
  }
  rule.integrands.functions.emplace_back([](double v) { return std::exp(-v); });
  rule.integrands.breaks = {7, 50};
  CHECK(generator::element_ends(p, rule) == plain);
}

TEST_CASE("mesh: elements end at breaks, with shorter ones beside and no slivers") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  auto rule = rule_to(7);
  const auto plain = generator::element_ends(p, rule);
  for (double v : {1e-5, 0.01, 0.3, 0.5, plain[4] * 1.01, plain[5] * 0.99, 2.0, 6.9}) {
    INFO(v);
    rule.integrands.breaks = {v};
    const auto ends = generator::element_ends(p, rule);
    CHECK(has(ends, v));
    CHECK(ends.back() == 7);
    CHECK(std::adjacent_find(ends.begin(), ends.end(), std::greater_equal<>()) == ends.end());
    CHECK(ends.size() <= plain.size() + 5);
    for (std::size_t n = 1; n + 1 < plain.size(); ++n) {
      const bool near = std::abs(plain[n] - v) < 0.2 * (plain[n] - plain[n - 1]);
      CHECK(has(ends, plain[n]) == !near);
    }
  }
  rule.integrands.breaks = {1.9, 2.0};
  const auto window = generator::element_ends(p, rule);
  CHECK(std::count_if(window.begin(), window.end(), [](double e) { return e > 1.9 && e < 2; }) ==
        0);
  // The drag counts as the integrands do.
  const auto bent = [](double v) { return -v - std::max(0.0, v - 2); };
  rule.integrands.breaks = {2};
  CHECK(has(with_law(bent, {2.0}), 2));
  CHECK(with_law(bent, {2.0}).size() < with_law(bent).size());
}

TEST_CASE("mesh: what is steep is halved until it is resolved, and not elsewhere") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  auto rule = rule_to(7);
  const auto plain = generator::element_ends(p, rule);
  for (double width : {0.2, 0.02, 1e-3}) {
    INFO(width);
    const model::FunctionOfSpeed step = [=](double v) { return std::tanh((v - 0.5) / width); };
    rule.integrands.functions = {step};
    const auto ends = generator::element_ends(p, rule);
    for (std::size_t n = 1; n < ends.size(); ++n) {
      CHECK(model::interpolation_error(step, ends[n - 1], ends[n]) < 1e-3);
    }
    const auto added = static_cast<double>(ends.size() - plain.size());
    CHECK(added <= 4 + 4 * std::log2(1 / width));
    CHECK(std::includes(ends.begin(), ends.end(), plain.begin(), plain.end()));
  }
  CHECK(with_law([](double v) {
          return -v - std::atan(50 * (v - 2)) - std::atan(50 * (v + 2));
        }).size() > plain.size() + 4);
  // Where no body goes nothing is halved.
  rule.integrands.functions = {[](double v) { return 3 + std::tanh((v - 6.5) / 0.01); }};
  CHECK(generator::element_ends(p, rule) == plain);
  rule.integrands.functions = {[](double v) { return std::sin(1e5 * v); }};
  CHECK(generator::element_ends(p, rule).size() == plain.size() + 100);
}

TEST_CASE("mesh: degrees of added elements are those of the regular one") {
  const auto p = process(0.25, 1, 0.25, {1, 0});
  auto rule = rule_to(7, 8);
  rule.whole_tail = true;
  const auto plain = generator::element_ends(p, rule);
  rule.integrands.breaks = {plain[1] / 2, plain[3] * 1.001, 0.9};
  const auto ends = generator::element_ends(p, rule);
  const auto degrees = generator::element_degrees(p, rule, 9);
  REQUIRE(degrees.size() + 1 == ends.size());
  const std::vector expected{6, 6, 7, 7, 8, 8, 9, 9, 9, 9};
  for (std::size_t e = 0; e < degrees.size(); ++e) {
    const auto above = std::lower_bound(plain.begin() + 1, plain.end(), ends[e + 1]);
    CHECK(degrees[e] == expected[above - plain.begin() - 1]);
  }
}

TEST_CASE("mesh: elements end where a level leaves a velocity for both sides, and shrink to it") {
  const model::Friction friction{1, 0.2, {}, {}, model::Stribeck{0.02}};
  model::Process p{{1, 0.25, 30}, friction, with_weakening({1, 0}, friction)};
  const auto distance = [&](int level) {  // of the two ends next to where the level parts
    const auto ends = generator::element_ends(p, rule_to(7));
    const double v = p.drag.balances(p.net_force(level)).front();
    const auto at = std::min_element(ends.begin() + 1, ends.end(), [v](double a, double b) {
      return std::abs(a - v) < std::abs(b - v);
    });
    const auto degrees = generator::element_degrees(p, rule_to(7), 10);
    CHECK(degrees.size() + 1 == ends.size());
    CHECK(std::abs(*at - v) <= 1e-12 * v + (at[1] - *at));
    return std::abs(*at - v) < 1e-12 * v ? std::max(at[1] - v, v - at[-1]) / v : 1;
  };
  for (int level : {2, 3}) CHECK(distance(level) < 1e-3);
  p.noise.tau = 0.01;  // jumps are much faster than they part
  for (int level : {2, 3}) CHECK(distance(level) > 1e-2);
}

TEST_CASE("mesh: friction that is rough at rest takes more layers there") {
  const auto layers = [](double exponent) {
    const model::Friction friction{0.9, 0.2, {}, {}, model::Stribeck{0.1, exponent}};
    return generator::natural_layers({{1, 0.25, 30}, friction, with_weakening({1, 0}, friction)},
                                     rule_to(7));
  };
  CHECK(layers(0.5) >= layers(1) + 8);
  CHECK(layers(1.5) >= layers(2) + 6);
}

TEST_CASE("tail velocity: beyond the last maximum of a density that falls and rises") {
  auto p = process(0.5, 1, 0.25, {0, 0});
  p.drag.law = [](double v) {
    return 1.5 * std::copysign(std::exp(-4 * (std::abs(v) - 3) * (std::abs(v) - 3)), v) - 0.1 * v;
  };
  p.drag.rises_until = 4;
  p.drag.reach = 100;
  const double v = generator::tail_velocity(p, 1e-10), drop = std::log(1e10) + 5;
  const double from_rest = p.drag.potential(v) - 0.5 * v;
  CHECK(v > 3);
  CHECK(from_rest <= -drop);  // the density at rest is the largest
  CHECK(from_rest >= -drop - 0.1);
}

TEST_CASE("tail: the largest speed is the least of what force, density and user allow") {
  model::Scene scene;
  scene.delta = 0.5;
  scene.noise_levels = 4;
  scene.friction = {1, 0.5};
  CHECK(generator::largest_speed(scene) == Approx(4 * 0.5 - 0.5));  // drag -v
  scene.v_max = 1;
  CHECK(generator::largest_speed(scene) == 1);
  scene.v_max.reset();
  scene.drag = {0, 0};
  CHECK(generator::largest_speed(scene) == generator::tail_velocity(scene.meant(), 1e-16));
}
