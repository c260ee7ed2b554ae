#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/simulation/path.hpp"
#include "stickslip/simulation/sampler.hpp"
#include "stickslip/support/infinity.hpp"

using namespace stickslip;
using model::Start;
using simulation::Duration;
using simulation::Estimate;
using simulation::Integrand;
using simulation::Sampler;
using simulation::Tally;
using simulation::Variable;
using simulation::Wanted;

namespace {

model::Process process(double bias = 0, double mu_d_minus = 0.25) {
  model::Process p{{1, 0.5, model::full_range(1, 0.5)}, {1, 0.25}, {1, 0}, bias};
  if (bias != 0) p.friction.mu_d_minus = mu_d_minus;
  return p;
}

/// X + g = 1.3 and -0.7, so that sliding always starts upwards.
model::Process telegraph() {
  model::Process p{{}, {1, 0.5}, {0, 0}, 0.3};
  p.noise.table =
      std::make_shared<const model::LevelTable>(std::vector<model::Level>{{-1, 1, 0}, {1, 0, 1}});
  return p;
}

Tally batches(const model::Process& p, const Wanted& wanted, int count, std::uint64_t seed = 1) {
  constexpr int most = 10000;
  Sampler sampler(p, wanted);
  Tally all = sampler.empty();
  for (int n = 0; n < count / most; ++n) {
    all.merge(sampler.batch(seed, static_cast<std::uint64_t>(n), most));
  }
  return all;
}

/// Whether the value is within 4.5 standard deviations.
bool holds(const Estimate& e, double value) {
  return std::abs(e.value - value) < 4.5 / 1.96 * std::max(e.high - e.value, e.value - e.low);
}

/// Times until |v| first reaches w, by steps of paths and the closed form of each piece.
double passage(simulation::Walk& walk, const model::Process& p, double w) {
  for (;;) {
    const auto before = walk.state();
    walk.step(kInfinity);
    if (std::abs(walk.state().v) < w) continue;
    const auto& friction = before.y > 0 ? p.friction : p.friction.mirrored();
    const double force = before.y * (before.x + p.bias) - friction.mu_d, c = p.drag.linear;
    return before.time + std::log((force - c * std::abs(before.v)) / (force - c * w)) / c;
  }
}

Estimate mean_passage(const model::Process& p, const Start& start, double w, int count) {
  const auto walk = simulation::make_walk(p);
  simulation::Comoments times(1);
  for (int n = 0; n < count; ++n) {
    walk->begin({7, static_cast<std::uint64_t>(n)}, start);
    times.add(std::array{passage(*walk, p, w)});
  }
  const double half = 1.96 * std::sqrt(times.variance_of_mean(std::array{1.0}));
  return {times.mean(0), times.mean(0) - half, times.mean(0) + half};
}

/// The share of sliding phases that start upwards, by how often excursions change sides.
double share_upwards(const model::Process& p) {
  const auto source = simulation::make_source(p, {});
  simulation::RandomStream random(3, 0);
  simulation::Excursion e;
  std::array<double, 2> turned{};
  for (int n = 0; n < 20000; ++n) {
    for (std::size_t side : {0, 1}) {
      source->draw(random, side, 0, e);
      turned[side] += e.turned ? 1 : 0;
    }
  }
  return turned[1] / (turned[0] + turned[1]);
}

bool agree(const Estimate& a, const Estimate& b) {
  return std::abs(a.value - b.value) < 4.5 / 1.96 * std::hypot(a.high - a.value, b.high - b.value);
}

}  // namespace

TEST_CASE("slips: closed forms of telegraph noise without drag, within 4.5 sigma") {
  Wanted wanted;
  wanted.displacement = true;
  wanted.speeds = {0.6};
  const auto t = batches(telegraph(), wanted, 200000);
  CHECK(holds(t.mean(Duration::slide), 5));
  CHECK(holds(t.slip()[0].second, 12));
  CHECK(t.slip()[2].second.value == Approx(t.slip()[0].second.value));
  const auto peak = t.probability(Variable::peak, 0.6, kInfinity);
  CHECK(holds(peak, 0.5399345734));
  CHECK(peak.high - peak.low < 0.005);
}

TEST_CASE(
    "slips: path and displacement of a sliding phase are speeds times durations of excursions") {
  Wanted wanted;
  wanted.displacement = true;
  for (double bias : {0.0, 0.3}) {
    const auto t = batches(process(bias, 0.5), wanted, 10000);
    const double time = t.mean(Duration::excursion).value;
    CHECK(t.slip()[0].second.value ==
          Approx(time * t.stationary(Integrand::v_size).value).epsilon(1e-12));
    CHECK(t.slip()[2].second.value ==
          Approx(time * t.stationary(Integrand::v).value).epsilon(1e-12).margin(1e-15));
  }
}

// The moments of L are derivatives of its transform, and the transform an integral of its
// distribution.
TEST_CASE("slips: transform, distribution and moments of the path belong to one another") {
  Wanted wanted;
  wanted.displacement = true;
  wanted.inverse_distance = {1e-4, 2};
  for (int n = 1; n <= 2000; ++n) wanted.path_edges.push_back(0.01 * n);
  for (double bias : {0.0, 0.3}) {
    const auto t = batches(process(bias), wanted, 20000);
    const double mean = t.slip()[0].second.value, variance = t.slip()[1].second.value, s = 1e-4;
    CHECK((1 - t.slip_transform(0).value) / s ==
          Approx(mean - s / 2 * (variance + mean * mean)).epsilon(1e-6));
    double sum = 0;
    for (int n = 0; n < 2000; ++n) {
      const double low = n == 0 ? 0 : wanted.path_edges[static_cast<std::size_t>(n) - 1];
      const double high = wanted.path_edges[static_cast<std::size_t>(n)];
      sum += t.probability(Variable::path, low, high).value * std::exp(-(low + high));
    }
    CHECK(t.slip_transform(1).value == Approx(sum).epsilon(1e-3));
    CHECK(t.slip()[3].second.value <= variance + mean * mean);
  }
}

// With a bias sliding phases from s- are slow, and rare.
TEST_CASE("passages: mean times are those of paths followed until they pass") {
  for (double bias : {0.0, 0.3}) {
    const auto p = process(bias, 1);
    Wanted wanted;
    wanted.speeds = {0.3, 0.8};
    const auto t = batches(p, wanted, 60000);
    const double up = share_upwards(p);
    for (double w : wanted.speeds) {
      INFO("bias " << bias << ", w " << w);
      const auto found = t.first_passage(w);
      const auto plus = mean_passage(p, {p.exit_level(true)}, w, 20000),
                 minus = mean_passage(p, {p.exit_level(false)}, w, 20000);
      const double value = up * plus.value + (1 - up) * minus.value,
                   half = std::hypot(up * (plus.high - plus.value),
                                     (1 - up) * (minus.high - minus.value));
      CHECK(agree(found[0].second, {value, value - half, value + half}));
      CHECK(agree(found[1].second, mean_passage(p, {0, 0, Start::Kind::rest}, w, 20000)));
    }
  }
}

// A cubic term too small to count sends the same case through the integrator.
TEST_CASE("passages: closed forms and the integrator cross at the same times, in rising order") {
  auto p = process();
  const Wanted wanted{.speeds = {0.01, 0.3, 0.7, 1.5}};
  const auto exact = simulation::make_source(p, wanted);
  p.drag.cubic = 1e-300;
  const auto integrated = simulation::make_source(p, wanted);
  simulation::RandomStream one(1, 0), other(1, 0);
  simulation::Excursion a, b;
  int all = 0;
  for (int n = 0; n < 2000; ++n) {
    exact->draw(one, 0, 0, a);
    integrated->draw(other, 0, 0, b);
    REQUIRE(a.passages.size() == b.passages.size());
    REQUIRE(a.passages.size() <= wanted.speeds.size());
    REQUIRE(std::is_sorted(a.passages.begin(), a.passages.end()));
    for (std::size_t w = 0; w < a.passages.size(); ++w) {
      REQUIRE(a.passages[w] > 0);
      REQUIRE(a.passages[w] < a.slide);
      REQUIRE(a.passages[w] == Approx(b.passages[w]).epsilon(1e-8));
      REQUIRE(a.peak >= wanted.speeds[w]);
      ++all;
    }
  }
  CHECK(all > 3000);
}

TEST_CASE("passages: of a speed that is never reached there is a lower bound") {
  for (double bias : {0.0, 0.3}) {
    const auto t = batches(process(bias), {.speeds = {1e-3, 50}}, 10000);
    const auto peak = t.probability(Variable::peak, 50, kInfinity);
    CHECK(peak.value == 0);
    CHECK(peak.low == 0);
    CHECK(peak.high > 1e-5);
    for (const auto& [name, e] : t.first_passage(50)) {
      INFO(name);
      const double least = t.samples() * t.mean(Duration::excursion).value / -std::log(0.025);
      CHECK(e.low == Approx(least).epsilon(0.01));
      CHECK(e.value == e.low);
      CHECK(e.high == kInfinity);
    }
    for (const auto& [name, e] : t.first_passage(1e-3)) {
      CHECK(e.low > 0);
      CHECK(e.value / e.low == Approx(e.high / e.value));
    }
  }
}

TEST_CASE("displacement: a stationary path spreads as E[V^2] t^2 and then as S_v(0) t") {
  for (double bias : {0.0, 0.3}) {
    INFO("bias " << bias);
    Wanted wanted;
    wanted.moments = wanted.displacement = wanted.travel = true;
    wanted.start = Start{0, 0, Start::Kind::stationary};
    wanted.time = {30, 1e-3, 20, 5};
    const auto t = batches(process(bias, 0.5), wanted, 20000);
    const auto mean = [&](std::size_t n) { return t.travel(n)[0].second; };
    const auto variance = [&](std::size_t n) { return t.travel(n)[1].second; };
    const auto drift = t.stationary(Integrand::v), square = t.stationary(Integrand::v_square),
               rate = t.spectrum_at_zero();
    const double spread = variance(0).value - variance(2).value;
    const double error =
        std::hypot(variance(0).high - variance(0).value, variance(2).high - variance(2).value) +
        10 * (rate.high - rate.value);
    CHECK(std::abs(spread - 10 * rate.value) < 2 * error);
    CHECK(variance(1).value ==
          Approx(1e-6 * (square.value - drift.value * drift.value)).epsilon(0.06));
    if (bias == 0) {
      CHECK(mean(3).value == 0);
      CHECK(mean(3).high == 0);
    } else {
      CHECK(holds(mean(3), 5 * drift.value));
      CHECK(mean(3).high - mean(3).value < 0.2 * mean(3).value);
    }
  }
}

// E[x(t)] is the integral of E[V], and up to a first jump all is known.
TEST_CASE("displacement: from a state it is the integral of the mean velocity") {
  Wanted wanted;
  wanted.travel = wanted.expectation = true;
  wanted.start = Start{1, -0.75};
  wanted.observables = {model::parse_observable("v", {1, 0.25})};
  for (int n = 0; n <= 40; ++n) wanted.time.push_back(0.05 * n);
  const auto t = batches(process(), wanted, 20000);
  double sum = 0;
  for (std::size_t n = 1; n <= 40; ++n) {
    sum += 0.025 * (t.expectation(0, n - 1).value + t.expectation(0, n).value);
    CHECK(t.travel(n)[0].second.value == Approx(sum).epsilon(0.01));
  }
  CHECK(t.travel(0)[0].second.value == 0);
  CHECK(t.travel(1)[0].second.value == Approx(0.05 * (-0.75 + 0.025 * 1.5)).epsilon(0.01));
  CHECK(t.travel(40)[1].second.value > t.travel(20)[1].second.value);
}
