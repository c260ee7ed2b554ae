#include <boost/math/special_functions/beta.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "../common/near.hpp"
#include "stickslip/simulation/tally.hpp"

using namespace stickslip;
using simulation::Duration;
using simulation::Estimate;
using simulation::Excursion;
using simulation::Tally;
using simulation::Wanted;

namespace {

constexpr double kNormal = 1.959963984540054;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Wanted kWanted{true, true, {0, 1.5}, {0, 0.3}, {1, 2, 4}};

std::vector<Excursion> sample() {
  std::vector<Excursion> all;
  const auto add = [&](double slide, double stick, double square, int entry, bool turned) {
    all.push_back({slide,
                   stick,
                   square,
                   2 * square,
                   square / 3,
                   stick + slide / 4,
                   slide,
                   entry,
                   turned,
                   10,
                   {slide / 2, {slide / 3, -square}}});
  };
  add(1, 2, 0.5, -1, true);
  add(0.5, 1.5, 0.25, 0, false);
  add(3, 0.5, 2, 1, false);
  add(2, 4, 1.5, 1, false);
  return all;
}

Tally of(const std::vector<Excursion>& all, const Wanted& wanted = kWanted) {
  Tally tally(wanted, 1);
  for (const auto& e : all) tally.add(e);
  return tally;
}

void check_estimate(const Estimate& found, double value, double sigma) {
  CHECK(found.value == Approx(value).epsilon(1e-13));
  CHECK(found.low == Approx(value - kNormal * sigma).epsilon(1e-12).margin(1e-14));
  CHECK(found.high == Approx(value + kNormal * sigma).epsilon(1e-12).margin(1e-14));
}

using Value = std::function<double(const Excursion&)>;

double duration(const Excursion& e) { return e.slide + e.stick; }

/// Mean and standard error by their definitions.
void check_mean(const Estimate& found, const std::vector<Excursion>& all, const Value& f) {
  const auto n = static_cast<double>(all.size());
  double mean = 0, variance = 0;
  for (const auto& e : all) mean += f(e) / n;
  for (const auto& e : all) variance += std::pow(f(e) - mean, 2) / (n * (n - 1));
  check_estimate(found, mean, std::sqrt(variance));
}

/// E[f]/E[T]: the residuals f - ratio T have mean 0.
void check_ratio(const Estimate& found, const std::vector<Excursion>& all, const Value& f) {
  const auto n = static_cast<double>(all.size());
  double sum = 0, time = 0, variance = 0;
  for (const auto& e : all) sum += f(e), time += duration(e);
  const double ratio = sum / time;
  for (const auto& e : all) variance += std::pow(f(e) - ratio * duration(e), 2);
  check_estimate(found, ratio, std::sqrt(variance * n / (n - 1)) / time);
}

/// Jeffreys' interval: quantiles of the beta law.
void check_proportion(const Estimate& found, int successes, int trials, double factor = 1) {
  const double a = successes + 0.5, b = trials - successes + 0.5;
  const double low = successes == 0 ? 0 : boost::math::ibeta_inv(a, b, 0.025);
  const double high = successes == trials ? 1 : boost::math::ibeta_inv(a, b, 0.975);
  CHECK(found.value == Approx(factor * successes / trials));
  CHECK(found.low == Approx(factor * low).epsilon(1e-9));
  CHECK(found.high == Approx(factor * high).epsilon(1e-9));
}

/// The formula of the spectrum with weights on the excursions.
double weighted_spectrum(const std::vector<Excursion>& all, const std::vector<double>& weight,
                         std::size_t w) {
  double power = 0, time = 0;
  std::complex<double> c, d, cd;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const auto& e = all[n];
    const auto turn = (e.turned ? -1.0 : 1.0) * std::polar(1.0, -kWanted.omega[w] * duration(e));
    power += weight[n] * std::norm(e.transform[w]);
    time += weight[n] * duration(e);
    c += weight[n] * e.transform[w];
    d += weight[n] * turn;
    cd += weight[n] * std::conj(e.transform[w]) * turn;
  }
  return (power + 2 * (cd * c / (1.0 - d)).real()) / time;
}

/// The value at even weights on n samples, and the variance by what each sample adds to it.
void check_influence(const Estimate& found, std::size_t n,
                     const std::function<double(const std::vector<double>&)>& of_weights) {
  constexpr double step = 1e-6;
  const auto count = static_cast<double>(n);
  const std::vector<double> even(n, 1 / count);
  double variance = 0;
  for (std::size_t m = 0; m < n; ++m) {
    auto more = even, less = even;
    for (auto& x : more) x *= 1 - step;
    for (auto& x : less) x *= 1 + step;
    more[m] += step;
    less[m] -= step;
    const double influence = (of_weights(more) - of_weights(less)) / (2 * step);
    variance += influence * influence / (count * (count - 1));
  }
  CHECK(found.value == Approx(of_weights(even)).epsilon(1e-12));
  CHECK(found.high - found.value == Approx(kNormal * std::sqrt(variance)).epsilon(1e-7));
  CHECK(found.value - found.low == Approx(kNormal * std::sqrt(variance)).epsilon(1e-7));
}

}  // namespace

TEST_CASE("tally: a sample of four by hand") {
  const auto t = of(sample());
  CHECK(t.samples() == 4);
  CHECK(t.jumps() == 40);
  CHECK(t.sliding().value == Approx(6.5 / 14.5).epsilon(1e-14));
  CHECK(t.sticking().value == Approx(8.0 / 14.5).epsilon(1e-14));
  CHECK(t.mean(Duration::slide).value == Approx(6.5 / 4).epsilon(1e-14));
  CHECK(t.mean(Duration::excursion).value == Approx(14.5 / 4).epsilon(1e-14));
  CHECK(t.mean_square().value == Approx(4.25 / 14.5).epsilon(1e-14));
  CHECK(t.probability(Duration::slide, 1, 2).value == 0.25);
  CHECK(t.laplace(0, Duration::excursion).value == 1);
}

TEST_CASE("tally: stationary means with intervals of the delta method") {
  const auto all = sample();
  const auto t = of(all);
  check_ratio(t.sliding(), all, [](const Excursion& e) { return e.slide; });
  check_ratio(t.sticking(), all, [](const Excursion& e) { return e.stick; });
  check_ratio(t.mean_square(), all, [](const Excursion& e) { return e.square; });
  check_ratio(t.mean_speed(), all, [](const Excursion& e) { return e.path; });
  check_ratio(t.mean_product(), all, [](const Excursion& e) { return e.product; });
  check_ratio(t.within(), all, [](const Excursion& e) { return e.within; });
  check_ratio(t.noise_square(), all, [](const Excursion& e) { return e.noise_square; });
}

TEST_CASE("tally: means of durations and of their exponentials") {
  const auto all = sample();
  const auto t = of(all);
  const std::vector<std::pair<Duration, Value>> durations{
      {Duration::slide, [](const Excursion& e) { return e.slide; }},
      {Duration::stick, [](const Excursion& e) { return e.stick; }},
      {Duration::excursion, duration}};
  for (const auto& [which, of_excursion] : durations) {
    check_mean(t.mean(which), all, of_excursion);
    for (std::size_t n = 0; n < 2; ++n) {
      const double lambda = kWanted.lambda[n];
      check_mean(t.laplace(n, which), all,
                 [&, f = of_excursion](const Excursion& e) { return std::exp(-lambda * f(e)); });
    }
  }
}

TEST_CASE("tally: cells of histograms count low <= D < high") {
  const auto t = of(sample());  // slides 1, 0.5, 3, 2; stays 2, 1.5, 0.5, 4
  check_proportion(t.probability(Duration::slide, 0, 1), 1, 4);
  check_proportion(t.probability(Duration::slide, 1, 2), 1, 4);
  check_proportion(t.probability(Duration::slide, 2, 4), 2, 4);
  check_proportion(t.probability(Duration::slide, 4, kInfinity), 0, 4);
  check_proportion(t.probability(Duration::slide, 0, kInfinity), 4, 4);
  check_proportion(t.probability(Duration::stick, 4, kInfinity), 1, 4);
  check_proportion(t.probability(Duration::stick, 1, 4), 2, 4);
  check_proportion(t.probability(Duration::excursion, 0, 4), 3, 4);
}

TEST_CASE("tally: entries are proportions in [0, 1] that hold their value") {
  const auto t = of(sample());
  check_proportion(t.entry(-1), 1, 4);
  check_proportion(t.entry(0), 1, 4);
  check_proportion(t.entry(1), 2, 4);
  check_proportion(t.entry_of_both(-1, 1, 3), 3, 4, 3);
  const auto never = of({sample()[0]}).entry(1), always = of({sample()[0]}).entry(-1);
  CHECK(never.value == 0);
  CHECK(never.low == 0);
  CHECK(never.high > 0.5);
  CHECK(never.high < 1);
  CHECK(always.value == 1);
  CHECK(always.high == 1);
  CHECK(always.low > 0);
}

TEST_CASE("tally: spectrum and its interval") {
  const auto all = sample();
  const auto t = of(all);
  for (std::size_t w = 0; w < 2; ++w) {
    check_influence(t.spectrum(w), 4, [&](const std::vector<double>& weight) {
      return weighted_spectrum(all, weight, w);
    });
  }
}

// Pushes of +-1 that last 1 and turn by the toss of a coin: S is that of one push.
TEST_CASE("tally: the spectrum of pushes without memory is that of one") {
  Wanted wanted{true, false, {2}, {}, {}};
  const auto push = (1.0 - std::polar(1.0, -2.0)) / std::complex<double>(0, 2);
  Tally t(wanted, 0);
  for (bool turned : {false, true}) {
    Excursion e;
    e.slide = 1;
    e.turned = turned;
    e.transform = {push};
    t.add(e);
  }
  CHECK(t.spectrum(0).value == Approx(std::norm(push)).epsilon(1e-14));
}

TEST_CASE("tally: one static level is left by both ways") {
  Tally t({}, 0);
  for (int n = 0; n < 3; ++n) {
    Excursion e;
    e.slide = e.stick = n + 1;
    t.add(e);
  }
  check_proportion(t.entry(0), 3, 3);
  CHECK(t.entry_of_both(0, 0, 5).value == 10);
  CHECK(t.entry_of_both(0, 0, 5).high == 10);
  CHECK(t.sticking().value == 0.5);
  CHECK(t.sticking().high == Approx(0.5).epsilon(1e-14));
}

TEST_CASE("tally: merged parts are the whole") {
  const auto all = sample();
  auto merged = of({all[0]});
  merged.merge(of({all[1], all[2], all[3]}));
  const auto whole = of(all);
  const auto a = merged.pack(), b = whole.pack();
  REQUIRE(a.size() == b.size());
  for (std::size_t n = 0; n < a.size(); ++n)
    CHECK(a[n] == Approx(b[n]).epsilon(1e-13).margin(1e-15));
}

TEST_CASE("tally: packed and unpacked it is the same, of other questions it is refused") {
  const auto whole = of(sample());
  auto back = of({sample()[0]});
  back.unpack(whole.pack());
  CHECK(back.pack() == whole.pack());
  CHECK(whole.packed_size() == whole.pack().size());
  simulation::Wanted cycles = kWanted;
  cycles.cycles = true;
  CHECK(Tally(cycles, 2).packed_size() == Tally(cycles, 2).pack().size());
  CHECK(back.spectrum(1).low == whole.spectrum(1).low);
  auto numbers = whole.pack();
  numbers.pop_back();
  CHECK_THROWS_AS(back.unpack(numbers), std::invalid_argument);
  CHECK_THROWS_AS(back.unpack({}), std::invalid_argument);
  CHECK_THROWS_AS(Tally(kWanted, 2).unpack(whole.pack()), std::invalid_argument);
}

TEST_CASE("tally: a batch is fixed by seed and number") {
  const model::Process p{{1, 0.5, 8}, {1, 0.25}, {1, 0}};
  const auto source = simulation::make_source(p, kWanted);
  const auto batch = [&](std::uint64_t seed, std::uint64_t number) {
    return simulation::simulate_batch(*source, kWanted, p.static_index(), seed, number, 20).pack();
  };
  const auto first = batch(1, 0);
  CHECK(batch(1, 1) != first);
  CHECK(batch(2, 0) != first);
  CHECK(batch(1, 0) == first);
  Tally by_hand(kWanted, p.static_index());
  simulation::RandomStream random(1, 7);
  Excursion e;
  for (int n = 0; n < 20; ++n) {
    source->draw(random, e);
    by_hand.add(e);
  }
  CHECK(batch(1, 7) == by_hand.pack());
}

namespace {

const Wanted kCycles{true, true, {}, {}, {}, true};

std::vector<Excursion> cycles() {
  const std::vector<double> moved{1, -0.5, 2, 0.25, 3}, slide{2, 1, 3, 1, 4},
      stick{1, 2, 0.5, 1, 1}, number{1, 3, 2, 1, 4};
  std::vector<Excursion> all(moved.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    all[n].slide = slide[n];
    all[n].stick = stick[n];
    all[n].drift = moved[n];
    all[n].count = number[n];
    all[n].jumps = 3;
  }
  return all;
}

// A bias may leave no static level at or above 0.
Tally of_cycles(const std::vector<Excursion>& all) {
  Tally tally(kCycles, -2);
  for (const auto& e : all) tally.add(e);
  return tally;
}

using Weights = std::vector<double>;

double weighted(const std::vector<Excursion>& all, const Weights& weight, const Value& f) {
  double sum = 0;
  for (std::size_t n = 0; n < all.size(); ++n) sum += weight[n] * f(all[n]);
  return sum;
}

}  // namespace

TEST_CASE("tally: drift of cycles is a stationary mean") {
  const auto all = cycles();
  check_ratio(of_cycles(all).mean_velocity(), all, [](const Excursion& e) { return e.drift; });
}

TEST_CASE("tally: mean durations in cycles are those of one excursion") {
  const auto all = cycles();
  const auto t = of_cycles(all);
  const std::vector<std::pair<Duration, Value>> durations{
      {Duration::slide, [](const Excursion& e) { return e.slide; }},
      {Duration::stick, [](const Excursion& e) { return e.stick; }},
      {Duration::excursion, duration}};
  const Value number = [](const Excursion& e) { return e.count; };
  for (const auto& [which, f] : durations) {
    check_influence(t.mean(which), all.size(), [&, f = f](const Weights& weight) {
      return weighted(all, weight, f) / weighted(all, weight, number);
    });
  }
  CHECK(t.mean(Duration::stick).value == Approx(5.5 / 11).epsilon(1e-13));
}

TEST_CASE("tally: the spread of cycles about their drift grows at the rate S_v(0)") {
  const auto all = cycles();
  check_influence(of_cycles(all).spectrum_at_zero(), all.size(), [&](const Weights& weight) {
    const double time = weighted(all, weight, duration);
    const double m = weighted(all, weight, [](const Excursion& e) { return e.drift; }) / time;
    const auto square = [m](const Excursion& e) { return std::pow(e.drift - m * duration(e), 2); };
    return weighted(all, weight, square) / time;
  });
}

TEST_CASE("tally: merged and packed cycles are the whole") {
  const auto all = cycles();
  auto merged = of_cycles({all[0], all[1]});
  merged.merge(of_cycles({all[2], all[3], all[4]}));
  const auto whole = of_cycles(all);
  const auto a = merged.pack(), b = whole.pack();
  REQUIRE(a.size() == b.size());
  for (std::size_t n = 0; n < a.size(); ++n) CHECK(a[n] == Approx(b[n]).epsilon(1e-13));
  CHECK(merged.spectrum_at_zero().high == Approx(whole.spectrum_at_zero().high).epsilon(1e-12));
  auto again = of_cycles({});
  again.unpack(b);
  CHECK(again.pack() == b);
}
