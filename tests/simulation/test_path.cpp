#include <algorithm>
#include <cmath>

#include "../common/catch.hpp"
#include "../common/tallies.hpp"
#include "stickslip/simulation/tally.hpp"
#include "stickslip/simulation/walk.hpp"

using namespace stickslip;
using simulation::Path;
using simulation::simulate_path;

namespace {

model::Process process(double mu_s, double mu_d, double tau, double delta, model::Drag drag) {
  return {{tau, delta, model::full_range(tau, delta)}, {mu_s, mu_d}, drag};
}

model::Process biased(double bias, model::Drag drag) {
  auto p = process(1, 0.25, 1, 0.5, std::move(drag));
  p.bias = bias;
  return p;
}

std::vector<model::Process> processes() {
  const model::Drag stronger_below{0, 0, [](double v) { return v > 0 ? -v : -2 * v; }, 1e6, false};
  return {process(1, 0.25, 1, 0.5, {1, 0}),
          process(1, 1, 1, 0.5, {0, 0}),
          process(0.2, 0.15, 1, 0.5, {1, 0}),
          process(0.2, 0.2, 2, 0.25, {0.3, 0.5}),
          biased(0.3, {1, 0}),
          biased(-0.6, {0.5, 0.25}),
          biased(0, stronger_below),
          biased(-0.2, stronger_below)};
}

// v after `time` with the force of this piece, by Runge-Kutta steps of order 4.
double flow(const model::Process& p, double x, double y, double v, double time) {
  constexpr int steps = 200;
  const double h = time / steps;
  const auto rate = [&](double u) { return x + p.bias - p.friction.mu_d * y + p.drag(u); };
  for (int n = 0; n < steps; ++n) {
    const double a = rate(v), b = rate(v + h / 2 * a), c = rate(v + h / 2 * b), d = rate(v + h * c);
    v += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return v;
}

// State n and what leads to n + 1.
void check_step(const model::Process& p, const Path& path, std::size_t n) {
  const double x = path.x[n], y = path.y[n], v = path.v[n];
  const double reached = y == 0 ? 0 : flow(p, x, y, v, path.time[n + 1] - path.time[n]);
  REQUIRE(path.time[n + 1] > path.time[n]);
  REQUIRE(path.v[n + 1] == Approx(reached).epsilon(1e-9).margin(1e-9));
  REQUIRE(reached * y >= -1e-9);  // never beyond a stop
}

void check_state(const model::Process& p, double x, double y, double v) {
  REQUIRE(x / p.noise.delta == std::round(x / p.noise.delta));
  REQUIRE((y == 0 || y == 1 || y == -1));
  REQUIRE(v * y >= 0);
  if (y == 0) REQUIRE(v == 0);
  const double force = x + p.bias;
  if (y == 0) REQUIRE(std::abs(force) <= p.friction.mu_s);
  if (v == 0 && std::abs(force) <= p.friction.mu_s) REQUIRE(y == 0);
  if (v == 0 && std::abs(force) > p.friction.mu_s) REQUIRE(y * force > 0);
}

}  // namespace

TEST_CASE("path: every state is one of the process and follows from the one before") {
  for (const auto& p : processes()) {
    const auto path = simulate_path(p, {0, 0}, 200, 1);
    REQUIRE(path.time.size() > 100);
    int rests = 0;
    for (std::size_t n = 0; n < path.time.size(); ++n) {
      check_state(p, path.x[n], path.y[n], path.v[n]);
      rests += path.y[n] == 0;
      if (n + 1 < path.time.size()) check_step(p, path, n);
    }
    CHECK(rests > 10);
    for (double sign : {1.0, -1.0}) CHECK(std::count(path.y.begin(), path.y.end(), sign) > 10);
  }
}

TEST_CASE("path: an event is a jump by one step or an end of motion, and the end is the horizon") {
  for (const auto& p : processes()) {
    const auto path = simulate_path(p, {0, 0}, 200, 2);
    CHECK(path.time.front() == 0);
    CHECK(path.time.back() == 200);
    for (std::size_t n = 0; n + 2 < path.time.size(); ++n) {
      const double jump = std::abs(path.x[n + 1] - path.x[n]);
      const bool jumps = jump == Approx(p.noise.delta).epsilon(1e-12);
      const bool stops = jump == 0 && path.y[n] != 0 && path.v[n + 1] == 0;
      REQUIRE((jumps || stops));
      if (stops) REQUIRE(path.y[n + 1] != path.y[n]);
    }
    CHECK(path.x.back() == *(path.x.end() - 2));
  }
}

TEST_CASE("path: starts where it is asked to, in motion, pushed or at rest") {
  const auto p = processes()[0];
  const auto moving = simulate_path(p, {1, -0.75}, 1, 1);
  CHECK(moving.x[0] == 0.5);
  CHECK(moving.y[0] == -1);
  CHECK(moving.v[0] == -0.75);
  const auto pushed = simulate_path(p, {-3, 0}, 1, 1);
  CHECK(pushed.y[0] == -1);
  CHECK(pushed.v[0] == 0);
  const auto resting = simulate_path(p, {2, 0}, 1, 1);  // x = mu_s is held
  CHECK(resting.y[0] == 0);
}

// Before the first jump: slowed down by friction and drag to rest.
TEST_CASE("path: a body in motion comes to rest where it should") {
  const auto p = process(1, 0.25, 1, 0.5, {1, 0});
  int seen = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto path = simulate_path(p, {0, -0.01}, 10, seed);
    if (path.x[1] != 0) continue;
    ++seen;
    CHECK(path.time[1] == Approx(std::log1p(0.01 / 0.25)).epsilon(1e-12));
    CHECK(path.y[1] == 0);
  }
  CHECK(seen > 100);
}

TEST_CASE("path: seeds repeat and differ, a longer horizon goes on from the same path") {
  const auto p = processes()[0];
  const auto path = simulate_path(p, {0, 0}, 20, 1), longer = simulate_path(p, {0, 0}, 40, 1);
  CHECK(path.v == simulate_path(p, {0, 0}, 20, 1).v);
  CHECK(path.time != simulate_path(p, {0, 0}, 20, 2).time);
  for (std::size_t n = 0; n + 1 < path.time.size(); ++n) {
    REQUIRE(longer.time[n] == path.time[n]);
    REQUIRE(longer.v[n] == path.v[n]);
  }
}

TEST_CASE("path: the noise jumps as often as it should, and has the variance it should") {
  const auto p = process(1, 0.25, 1, 0.5, {1, 0});
  constexpr double horizon = 20000;
  const auto path = simulate_path(p, {0, 0}, horizon, 3);
  double jumps = 0, square = 0;
  for (std::size_t n = 0; n + 1 < path.time.size(); ++n) {
    jumps += path.x[n + 1] != path.x[n];
    square += path.x[n] * path.x[n] * (path.time[n + 1] - path.time[n]);
  }
  const double expected = p.noise.rate() * horizon;
  CHECK(std::abs(jumps - expected) < 4 * std::sqrt(expected));
  // Var[X^2] = 2 and its correlation decays as exp(-2 t/tau): sigma^2 = 2 tau Var/(2 horizon).
  CHECK(std::abs(square / horizon - 1) < 4 * std::sqrt(2 / horizon));
}

TEST_CASE(
    "path: from rest the noise has its stationary distribution, and only pushed bodies move") {
  const auto p = process(1, 0.25, 1, 0.5, {1, 0});
  double square = 0;
  constexpr int count = 4000;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const auto path = simulate_path(p, {0, 0, model::Start::Kind::rest}, 0.01, seed);
    const double x = path.x[0];
    square += x * x / count;
    REQUIRE(path.v[0] == 0);
    REQUIRE(path.y[0] == (std::abs(x) <= 1 ? 0 : x > 0 ? 1 : -1));
  }
  CHECK(std::abs(square - 1) < 4 * std::sqrt(2.0 / count));
}

TEST_CASE("path: levels are drawn in proportion to their probabilities") {
  const model::NoiseChain noise{1, 0.5, 8};
  const auto weight = model::stationary_distribution(noise);
  const simulation::NoiseLevels levels(noise);
  std::vector<double> share(weight.size(), 0.0);
  constexpr int count = 100000;
  for (int n = 0; n < count; ++n) {
    share[static_cast<std::size_t>(levels.draw((n + 0.5) / count) + 8)] += 1.0 / count;
  }
  for (std::size_t i = 0; i < weight.size(); ++i) CHECK(std::abs(share[i] - weight[i]) < 2e-5);
}

// Of starts at times within long paths, with means over time known from excursions.
TEST_CASE("path: a stationary start has the stationary distribution within 4 sigma") {
  const auto p = process(1, 0.25, 1, 0.5, {1, 0});
  using cases::Quantity;
  simulation::Sampler sampler({.quantities = {Quantity::sticking, Quantity::moments}}, p);
  const auto& known = sampler.batch(1, 0, 50000);
  constexpr int count = 400;
  double square = 0, fourth = 0, resting = 0;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const auto path = simulate_path(p, {0, 0, model::Start::Kind::stationary}, 0.01, seed);
    REQUIRE(path.time[0] == 0);
    REQUIRE(path.time.back() == 0.01);
    square += path.v[0] * path.v[0] / count;
    fourth += std::pow(path.v[0], 4) / count;
    resting += path.y[0] == 0 ? 1.0 / count : 0;
  }
  const double share = test::estimate(known, "P_stick").value;
  CHECK(std::abs(square - test::estimate(known, "E_V2").value) <
        4 * std::sqrt((fourth - square * square) / count));
  CHECK(std::abs(resting - share) < 4 * std::sqrt(share * (1 - share) / count));
}
