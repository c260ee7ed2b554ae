#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "../common/catch.hpp"
#include "../common/tallies.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/simulation/tally.hpp"
#include "stickslip/simulation/walk.hpp"

using namespace stickslip;
using cases::Quantity;
using model::Start;
using simulation::Estimate;
using simulation::Sampler;
using simulation::Tally;
using test::estimate;
using test::estimates;

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

Tally batches(const model::Process& p, const cases::Question& question, int count,
              std::uint64_t seed = 1) {
  constexpr int most = 10000;
  Sampler sampler(question, p);
  Tally all(question, p);
  for (int n = 0; n < count / most; ++n) {
    all.merge(sampler.batch(seed, static_cast<std::uint64_t>(n), most).pack());
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
      source->draw(random, p.exit_level(side == 0), 0, e);
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
  const cases::Question question{.quantities = {Quantity::sticking, Quantity::slip, Quantity::peak},
                                 .velocity = {0.6}};
  const auto t = batches(telegraph(), question, 200000);
  CHECK(holds(estimate(t, "mean_slide"), 5));
  CHECK(holds(estimate(t, "mean_slip"), 12));
  CHECK(estimate(t, "mean_slip_net").value == Approx(estimate(t, "mean_slip").value));
  const auto peak = estimate(t, "P_peak");
  CHECK(holds(peak, 0.5399345734));
  CHECK(peak.high - peak.low < 0.005);
}

TEST_CASE(
    "slips: path and displacement of a sliding phase are speeds times durations of excursions") {
  const cases::Question question{
      .quantities = {Quantity::sticking, Quantity::moments, Quantity::slip}};
  for (double bias : {0.0, 0.3}) {
    const auto t = batches(process(bias, 0.5), question, 10000);
    const double time = estimate(t, "mean_excursion").value;
    CHECK(estimate(t, "mean_slip").value ==
          Approx(time * estimate(t, "E_absV").value).epsilon(1e-12));
    CHECK(estimate(t, "mean_slip_net").value ==
          Approx(time * estimate(t, "E_V").value).epsilon(1e-12).margin(1e-15));
  }
}

// The moments of L are derivatives of its transform, and the transform an integral of its
// distribution.
TEST_CASE("slips: transform, distribution and moments of the path belong to one another") {
  cases::Question question{.quantities = {Quantity::slip}, .inverse_distance = {1e-4, 2}};
  for (int n = 1; n <= 1000; ++n) question.distance.push_back(0.02 * n);
  for (double bias : {0.0, 0.3}) {
    const auto t = batches(process(bias), question, 20000);
    const double mean = estimate(t, "mean_slip").value, variance = estimate(t, "var_slip").value,
                 s = 1e-4;
    CHECK((1 - estimate(t, "F_slip", 0).value) / s ==
          Approx(mean - s / 2 * (variance + mean * mean)).epsilon(1e-6));
    double sum = 0, low = 0, below = 0;
    const auto cdf = estimates(t, "cdf_slip");
    for (std::size_t n = 0; n < cdf.size(); ++n) {
      const double high = question.distance[n];
      sum += (cdf[n].value - below) * std::exp(-(low + high));
      low = high;
      below = cdf[n].value;
    }
    CHECK(estimate(t, "F_slip", 1).value == Approx(sum).epsilon(1e-3));
    CHECK(estimate(t, "var_slip_net").value <= variance + mean * mean);
  }
}

// With a bias sliding phases from s- are slow, and rare.
TEST_CASE("passages: mean times are those of paths followed until they pass") {
  for (double bias : {0.0, 0.3}) {
    const auto p = process(bias, 1);
    const cases::Question question{.quantities = {Quantity::peak}, .velocity = {0.8, 0.3}};
    const auto t = batches(p, question, 60000);
    const double up = share_upwards(p);
    for (std::size_t n : {0, 1}) {
      const double w = question.velocity[n];
      INFO("bias " << bias << ", w " << w);
      const auto plus = mean_passage(p, {p.exit_level(true)}, w, 20000),
                 minus = mean_passage(p, {p.exit_level(false)}, w, 20000);
      const double value = up * plus.value + (1 - up) * minus.value,
                   half = std::hypot(up * (plus.high - plus.value),
                                     (1 - up) * (minus.high - minus.value));
      CHECK(agree(estimate(t, "mean_first_passage", n), {value, value - half, value + half}));
      CHECK(agree(estimate(t, "mean_first_passage_rest", n),
                  mean_passage(p, {0, 0, Start::Kind::rest}, w, 20000)));
    }
  }
}

// A cubic term too small to count sends the same case through the integrator.
TEST_CASE("passages: closed forms and the integrator cross at the same times, in rising order") {
  auto p = process();
  const simulation::Wanted wanted{.speeds = {0.01, 0.3, 0.7, 1.5}};
  const auto exact = simulation::make_source(p, wanted);
  p.drag.cubic = 1e-300;
  const auto integrated = simulation::make_source(p, wanted);
  simulation::RandomStream one(1, 0), other(1, 0);
  simulation::Excursion a, b;
  const int start = p.exit_level(true);
  int all = 0;
  for (int n = 0; n < 2000; ++n) {
    exact->draw(one, start, 0, a);
    integrated->draw(other, start, 0, b);
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
    const auto t = batches(
        process(bias), {.quantities = {Quantity::sticking, Quantity::peak}, .velocity = {50, 1e-3}},
        10000);
    const auto peak = estimate(t, "P_peak");
    CHECK(peak.value == 0);
    CHECK(peak.low == 0);
    CHECK(peak.high > 1e-5);
    for (const char* key : {"mean_first_passage", "mean_first_passage_rest"}) {
      INFO(key);
      const auto never = estimate(t, key, 0), often = estimate(t, key, 1);
      const double least = t.samples() * estimate(t, "mean_excursion").value / -std::log(0.025);
      CHECK(never.low == Approx(least).epsilon(0.01));
      CHECK(never.value == never.low);
      CHECK(never.high == kInfinity);
      CHECK(often.low > 0);
      CHECK(often.value / often.low == Approx(often.high / often.value));
    }
  }
}

TEST_CASE("displacement: a stationary path spreads as E[V^2] t^2 and then as S_v(0) t") {
  for (double bias : {0.0, 0.3}) {
    INFO("bias " << bias);
    const cases::Question question{
        .quantities = {Quantity::moments, Quantity::spectrum, Quantity::displacement},
        .time = {30, 1e-3, 20, 5},
        .start = {0, 0, Start::Kind::stationary}};
    const auto t = batches(process(bias, 0.5), question, 20000);
    const auto mean = [&](std::size_t n) { return estimate(t, "displacement_mean", n); };
    const auto variance = [&](std::size_t n) { return estimate(t, "displacement_variance", n); };
    const auto drift = estimate(t, "E_V"), square = estimate(t, "E_V2"), rate = estimate(t, "S_0");
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
  cases::Question question{.quantities = {Quantity::displacement, Quantity::expectation},
                           .observables = {model::parse_observable("v", {1, 0.25})},
                           .start = {1, -0.75}};
  for (int n = 0; n <= 40; ++n) question.time.push_back(0.05 * n);
  const auto t = batches(process(), question, 20000);
  double sum = 0;
  for (std::size_t n = 1; n <= 40; ++n) {
    sum += 0.025 * (estimate(t, "E(v)", n - 1).value + estimate(t, "E(v)", n).value);
    CHECK(estimate(t, "displacement_mean", n).value == Approx(sum).epsilon(0.01));
  }
  CHECK(estimate(t, "displacement_mean", 0).value == 0);
  CHECK(estimate(t, "displacement_mean", 1).value ==
        Approx(0.05 * (-0.75 + 0.025 * 1.5)).epsilon(0.01));
  CHECK(estimate(t, "displacement_variance", 40).value >
        estimate(t, "displacement_variance", 20).value);
}
