#include <algorithm>
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
using simulation::Estimate;
using simulation::Sampler;
using simulation::Tally;
using test::estimate;

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
