#include <array>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <functional>

#include "../common/catch.hpp"
#include "../common/tallies.hpp"
#include "stickslip/simulation/tally.hpp"

using namespace stickslip;
using cases::Quantity;
using simulation::Estimate;
using simulation::Excursion;
using simulation::Tally;
using test::estimate;

namespace {

constexpr double kNormal = 1.959963984540054;
const cases::Question kQuestion{.quantities = {Quantity::sticking, Quantity::moments,
                                               Quantity::noise_law, Quantity::averages,
                                               Quantity::entry_law, Quantity::laplace,
                                               Quantity::duration_density, Quantity::spectrum},
                                .lambda = {0, 0.3},
                                .omega = {0.4, 1.5},
                                .time = {1, 2, 4}};

/// With static levels |i| <= k; 0, 1 and 2 with k = 1 and a bias of -0.4.
model::Process process(int k, double bias = 0) {
  model::Process p{{1, 0.5, 8}, {0.5 * k + 0.1, 0.1}, {1, 0}, bias};
  if (bias != 0) p.friction.mu_d_minus = 0.3;
  return p;
}

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
                   {slide / 2, {slide / 3, -square}},
                   (turned ? 1 : -1) * square});
  };
  add(1, 2, 0.5, -1, true);
  add(0.5, 1.5, 0.25, 0, false);
  add(3, 0.5, 2, 1, false);
  add(2, 4, 1.5, 1, false);
  return all;
}

Tally of(const std::vector<Excursion>& all, const cases::Question& question = kQuestion) {
  Tally tally(question, process(1));
  for (const auto& e : all) tally.add(0, e);
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

/// Jeffreys' interval: quantiles of the beta distribution.
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
    const auto turn = (e.turned ? -1.0 : 1.0) * std::polar(1.0, -kQuestion.omega[w] * duration(e));
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

TEST_CASE("tally: stationary means with intervals of the delta method") {
  const auto all = sample();
  const auto t = of(all);
  check_ratio(estimate(t, "P_slide"), all, [](const Excursion& e) { return e.slide; });
  check_ratio(estimate(t, "P_stick"), all, [](const Excursion& e) { return e.stick; });
  check_ratio(estimate(t, "E_V2"), all, [](const Excursion& e) { return e.square; });
  check_ratio(estimate(t, "E_absV"), all, [](const Excursion& e) { return e.path; });
  check_ratio(estimate(t, "E_XV"), all, [](const Excursion& e) { return e.product; });
  check_ratio(estimate(t, "P_X_le_mu_s"), all, [](const Excursion& e) { return e.within; });
  check_ratio(estimate(t, "E_X2"), all, [](const Excursion& e) { return e.noise_square; });
}

TEST_CASE("tally: means of durations and of their exponentials") {
  const auto all = sample();
  const auto t = of(all);
  const std::vector<std::pair<std::string, Value>> durations{
      {"slide", [](const Excursion& e) { return e.slide; }},
      {"stick", [](const Excursion& e) { return e.stick; }},
      {"excursion", duration}};
  for (const auto& [which, of_excursion] : durations) {
    check_mean(estimate(t, "mean_" + which), all, of_excursion);
    for (std::size_t n = 0; n < 2; ++n) {
      const double lambda = kQuestion.lambda[n];
      check_mean(estimate(t, "F_" + which, n), all,
                 [&, f = of_excursion](const Excursion& e) { return std::exp(-lambda * f(e)); });
    }
  }
}

// Cells [0.5, 1.5), [1.5, 3) and [3, 5) around 1, 2 and 4.
TEST_CASE("tally: cells of histograms count low <= D < high") {
  const auto t = of(sample());  // sliding 1, 0.5, 3, 2; sticking 2, 1.5, 0.5, 4
  check_proportion(estimate(t, "cdf_slide", 0), 1, 4);
  check_proportion(estimate(t, "cdf_slide", 1), 2, 4);
  check_proportion(estimate(t, "cdf_slide", 2), 4, 4);
  check_proportion(estimate(t, "cdf_stick", 0), 1, 4);
  check_proportion(estimate(t, "cdf_stick", 2), 3, 4);
  check_proportion(estimate(t, "cdf_excursion", 2), 3, 4);
  check_proportion(estimate(t, "f_slide", 0), 2, 4);
  check_proportion(estimate(t, "f_slide", 1), 1, 4, 1 / 1.5);
  check_proportion(estimate(t, "f_stick", 1), 2, 4, 1 / 1.5);
  check_proportion(estimate(t, "f_excursion", 2), 2, 4, 0.5);
}

TEST_CASE("tally: entries are proportions in [0, 1] that hold their value") {
  const auto t = of(sample());
  check_proportion(estimate(t, "entry_law", 0), 1, 4);
  check_proportion(estimate(t, "entry_law", 1), 1, 4);
  check_proportion(estimate(t, "entry_law", 2), 2, 4);
  check_proportion(estimate(t, "f_stick_0"), 3, 4, process(1).noise.up_rate(1));
  const auto never = estimate(of({sample()[0]}), "entry_law", 2),
             always = estimate(of({sample()[0]}), "entry_law", 0);
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
    check_influence(estimate(t, "S_v", w), 4, [&](const std::vector<double>& weight) {
      return weighted_spectrum(all, weight, w);
    });
  }
}

TEST_CASE("tally: one static level is left by both ways") {
  Tally t({.quantities = {Quantity::sticking, Quantity::entry_law}}, process(0));
  for (int n = 0; n < 3; ++n) {
    Excursion e;
    e.slide = e.stick = n + 1;
    t.add(0, e);
  }
  check_proportion(estimate(t, "entry_law", 0), 3, 3);
  const double rate = process(0).noise.up_rate(0) + process(0).noise.down_rate(0);
  CHECK(estimate(t, "f_stick_0").value == rate);
  CHECK(estimate(t, "f_stick_0").high == rate);
  CHECK(estimate(t, "P_stick").value == 0.5);
  CHECK(estimate(t, "P_stick").high == Approx(0.5).epsilon(1e-14));
}

TEST_CASE("tally: merged parts are the whole") {
  const auto all = sample();
  auto merged = of({all[0]});
  merged.merge(of({all[1], all[2], all[3]}).pack());
  const auto whole = of(all);
  const auto a = merged.pack(), b = whole.pack();
  REQUIRE(a.size() == b.size());
  for (std::size_t n = 0; n < a.size(); ++n)
    CHECK(a[n] == Approx(b[n]).epsilon(1e-13).margin(1e-15));
}

TEST_CASE(
    "tally: packed and merged into nothing it is the same, of other questions it is refused") {
  const auto whole = of(sample());
  auto back = of({sample()[0]});
  back.clear();
  CHECK(back.samples() == 0);
  back.merge(whole.pack());
  CHECK(back.pack() == whole.pack());
  CHECK(estimate(back, "S_v", 1).low == estimate(whole, "S_v", 1).low);
  auto numbers = whole.pack();
  numbers.pop_back();
  CHECK_THROWS_AS(back.merge(numbers), std::invalid_argument);
  CHECK_THROWS_AS(back.merge({}), std::invalid_argument);
  CHECK_THROWS_AS(Tally(kQuestion, process(2)).merge(whole.pack()), std::invalid_argument);
}

TEST_CASE("tally: there are estimates for each quantity that is said to be simulated") {
  for (const auto* entry : cases::entries()) {
    INFO(entry->word);
    const bool simulated = entry->routes.contains(cases::Route::monte_carlo);
    const auto p = process(1);
    const Tally t({.quantities = {entry->quantity},
                   .lambda = {1},
                   .omega = {1},
                   .time = {1},
                   .distance = {1},
                   .velocity = {1},
                   .observables = {model::parse_observable("v", p.friction)}},
                  p);
    CHECK(t.estimates().empty() == (!simulated || entry->of_one_run));
  }
}

TEST_CASE("tally: a batch is fixed by seed and number") {
  simulation::Sampler sampler(kQuestion, {{1, 0.5, 8}, {1, 0.25}, {1, 0}});
  const auto batch = [&](std::uint64_t seed, std::uint64_t number) {
    return sampler.batch(seed, number, 20).pack();
  };
  const auto first = batch(1, 0);
  CHECK(batch(1, 1) != first);
  CHECK(batch(2, 0) != first);
  CHECK(batch(1, 0) == first);
}

namespace {

using Weights = std::vector<double>;

double weighted(const std::vector<Excursion>& all, const Weights& weight, const Value& f) {
  double sum = 0;
  for (std::size_t n = 0; n < all.size(); ++n) sum += weight[n] * f(all[n]);
  return sum;
}

/// Samples from both sides, and those from s- after those from s+ in the weights.
struct TwoSides {
  std::vector<Excursion> plus, minus;

  [[nodiscard]] Tally tally(const cases::Question& question = kQuestion) const {
    Tally t(question, process(1, -0.4));
    for (const auto& e : plus) t.add(0, e);
    for (const auto& e : minus) t.add(1, e);
    return t;
  }
  /// Means over both sides with the shares of the chain of sides.
  [[nodiscard]] double overall(const Weights& weight, const Value& f) const {
    const Weights up(weight.begin(), weight.begin() + 5), down(weight.begin() + 5, weight.end());
    const auto turned = [](const Excursion& e) { return e.turned ? 1.0 : 0.0; };
    const double a = weighted(plus, up, turned), b = weighted(minus, down, turned);
    return (b * weighted(plus, up, f) + a * weighted(minus, down, f)) / (a + b);
  }
};

TwoSides two_sides() {
  TwoSides two;
  const std::vector<double> moved{1, -0.5, 2, 0.25, 3, -1, 0.1, -2, -0.3, -1.5},
      slide{2, 1, 3, 1, 4, 0.5, 1, 2, 3, 1}, stick{1, 2, 0.5, 1, 1, 1, 2, 3, 0.2, 0.7};
  for (std::size_t n = 0; n < moved.size(); ++n) {
    Excursion e;
    e.slide = slide[n];
    e.stick = stick[n];
    e.drift = moved[n];
    e.path = std::abs(moved[n]) + 0.1;
    e.entry = static_cast<int>(n) % 2;
    e.turned = n == 1 || n == 2 || n > 6;
    e.transform = {{moved[n], -slide[n] / 3}, {moved[n] / 2, slide[n] / 4}};
    (n < 5 ? two.plus : two.minus).push_back(e);
  }
  return two;
}

/// As check_influence, with five samples from each side.
void check_sides(const Estimate& found, const std::function<double(const Weights&)>& of_weights) {
  constexpr double step = 1e-6;
  Weights even(10, 0.2);
  double variance = 0;
  for (std::size_t m = 0; m < 10; ++m) {
    auto more = even, less = even;
    for (std::size_t n = m < 5 ? 0 : 5; n < (m < 5 ? 5U : 10U); ++n) {
      more[n] *= 1 - step;
      less[n] *= 1 + step;
    }
    more[m] += step;
    less[m] -= step;
    variance += std::pow((of_weights(more) - of_weights(less)) / (2 * step), 2) / 20;
  }
  CHECK(found.value == Approx(of_weights(even)).epsilon(1e-12));
  CHECK(found.high - found.value == Approx(kNormal * std::sqrt(variance)).epsilon(1e-7));
}

}  // namespace

TEST_CASE("tally: means over both sides are those of a long path") {
  const auto two = two_sides();
  const auto t = two.tally();
  const auto mean = [&](const Value& f) {
    return [&two, f](const Weights& weight) { return two.overall(weight, f); };
  };
  const auto over_time = [&](const Value& f) {
    return [&two, f](const Weights& weight) {
      return two.overall(weight, f) / two.overall(weight, duration);
    };
  };
  const Value slide = [](const Excursion& e) { return e.slide; };
  check_sides(estimate(t, "mean_slide"), mean(slide));
  check_sides(estimate(t, "mean_excursion"), mean(duration));
  check_sides(estimate(t, "P_slide"), over_time(slide));
  check_sides(estimate(t, "E_V"), over_time([](const Excursion& e) { return e.drift; }));
  check_sides(estimate(t, "friction_power"), over_time([](const Excursion& e) {
                return 0.05 * (e.path + e.drift) + 0.15 * (e.path - e.drift);
              }));
  check_sides(estimate(t, "slip_rate"),
              [&](const Weights& weight) { return 1 / two.overall(weight, duration); });
  check_sides(estimate(t, "var_excursion"), [&](const Weights& weight) {
    const double m = two.overall(weight, duration);
    return two.overall(weight, [m](const Excursion& e) { return std::pow(duration(e) - m, 2); });
  });
  check_sides(estimate(t, "F_slide", 1),
              mean([](const Excursion& e) { return std::exp(-0.3 * e.slide); }));
}

// Jeffreys' interval of as many trials as have the variance of the delta method.
TEST_CASE("tally: shares over both sides are those of a long path") {
  const auto two = two_sides();
  const auto t = two.tally();
  const auto short_slide = [](const Excursion& e) { return e.slide < 2 ? 1.0 : 0.0; };
  const auto lowest = [](const Excursion& e) { return e.entry == 0 ? 1.0 : 0.0; };
  const Weights even(10, 0.2);
  CHECK(estimate(t, "cdf_slide", 1).value == Approx(two.overall(even, short_slide)).epsilon(1e-13));
  // No sliding phase ended on the highest level.
  const double rate = process(1, -0.4).noise.down_rate(0);
  CHECK(estimate(t, "f_stick_0").value == Approx(rate * two.overall(even, lowest)).epsilon(1e-13));
  check_proportion(estimate(t, "entry_law", 1), 2, 5);
  check_proportion(estimate(t, "entry_law_minus", 1), 3, 5);
  check_proportion(estimate(t, "entry_law_minus", 2), 0, 5);
}

// Of exp(-0.3 T) three long sliding phases of 20000 longer ones make all: shorter ones may be
// missed.
TEST_CASE("tally: a transform that few samples carry has the interval of what they may miss") {
  constexpr int count = 20000;
  const auto of_slides = [](const std::function<double(int)>& slide) {
    std::vector<Excursion> all(count);
    for (int n = 0; n < count; ++n) all[static_cast<std::size_t>(n)].slide = slide(n);
    const auto tally = of(all, {.quantities = {Quantity::laplace}, .lambda = {0.3}});
    return estimate(tally, "F_slide", 0);
  };
  const auto few = of_slides([](int n) { return n % 7000 == 0 ? 20.0 : 100.0; });
  CHECK(few.value == Approx(3 * std::exp(-6.0) / count).epsilon(1e-6));
  CHECK(few.high == Approx(boost::math::ibeta_inv(0.5, count, 0.975)).epsilon(0.02));
  CHECK(few.value - few.low == Approx(few.high - few.value).epsilon(1e-9));
  const auto many = of_slides([](int n) { return n % 70 == 0 ? 20.0 : 100.0; });
  CHECK(many.high == Approx(many.value * (1 + kNormal * std::sqrt(70.0 / count))).epsilon(0.01));
}

// Many samples, where both intervals are the same.
TEST_CASE("tally: intervals of shares over both sides are those of means") {
  const auto two = two_sides();
  Tally t(kQuestion, process(1, -0.4));
  for (int n = 0; n < 20000; ++n) {
    t.add(0, two.plus[static_cast<std::size_t>(n * 7 % 5)]);
    t.add(1, two.minus[static_cast<std::size_t>(n * 3 % 5)]);
  }
  const auto share = estimate(t, "cdf_stick", 1);
  Tally other(kQuestion, process(1, -0.4));
  for (int n = 0; n < 20000; ++n) {
    for (std::size_t side : {0, 1}) {
      const std::size_t at = static_cast<std::size_t>(side == 0 ? n * 7 % 5 : n * 3 % 5);
      auto e = (side == 0 ? two.plus : two.minus)[at];
      e.slide = e.stick < 2 ? 1 : 0;
      other.add(side, e);
    }
  }
  const auto mean = estimate(other, "mean_slide");
  CHECK(share.value == Approx(mean.value).epsilon(1e-12));
  CHECK(share.high - share.low == Approx(mean.high - mean.low).epsilon(1e-3));
}

namespace {

/// The spread of the displacement in place of its values: E[(D - m T) u(next)] by the equation of
/// the chain of sides, solved by iteration over many steps.
double spread_by_steps(const TwoSides& two, const Weights& weight) {
  const double time = two.overall(weight, duration);
  const double m = two.overall(weight, [](const Excursion& e) { return e.drift; }) / time;
  const auto w = [m](const Excursion& e) { return e.drift - m * duration(e); };
  std::array<double, 2> to_come{};
  for (int step = 0; step < 200; ++step) {
    std::array<double, 2> next{};
    for (std::size_t side : {0, 1}) {
      const auto& all = side == 0 ? two.plus : two.minus;
      for (std::size_t n = 0; n < 5; ++n) {
        const std::size_t to = all[n].turned ? 1 - side : side;
        next[side] += weight[5 * side + n] * (w(all[n]) + to_come[to]);
      }
    }
    to_come = next;
  }
  double sum = 0;
  const auto turned = [](const Excursion& e) { return e.turned ? 1.0 : 0.0; };
  const Weights up(weight.begin(), weight.begin() + 5), down(weight.begin() + 5, weight.end());
  const double a = weighted(two.plus, up, turned), b = weighted(two.minus, down, turned);
  for (std::size_t side : {0, 1}) {
    const auto& all = side == 0 ? two.plus : two.minus;
    for (std::size_t n = 0; n < 5; ++n) {
      const double ahead = to_come[all[n].turned ? 1 - side : side], here = w(all[n]);
      sum +=
          (side == 0 ? b : a) / (a + b) * weight[5 * side + n] * (here * here + 2 * here * ahead);
    }
  }
  return sum / time;
}

}  // namespace

TEST_CASE("tally: the spread about the drift grows at the rate S_v(0)") {
  const auto two = two_sides();
  check_sides(estimate(two.tally(), "S_0"),
              [&](const Weights& weight) { return spread_by_steps(two, weight); });
}

// With s- the mirror image of s+ both forms are the same.
TEST_CASE("tally: two sides that mirror each other give what symmetry gives") {
  const auto all = sample();
  Tally two(kQuestion, process(1, 1e-300));
  for (auto e : all) {
    two.add(0, e);
    e.drift = -e.drift;
    for (auto& c : e.transform) c = -c;
    e.entry = -e.entry;
    two.add(1, e);
  }
  const auto one = of(all);
  for (std::size_t w : {0, 1}) {
    CHECK(estimate(two, "S_v", w).value == Approx(estimate(one, "S_v", w).value).epsilon(1e-12));
  }
  CHECK(estimate(two, "S_0").value == Approx(estimate(one, "S_0").value).epsilon(1e-12));
  CHECK(estimate(two, "P_slide").value == Approx(estimate(one, "P_slide").value).epsilon(1e-13));
  CHECK(estimate(two, "f_slide", 1).value == 0.25 / 1.5);
}

TEST_CASE("tally: both sides merged and packed are the whole") {
  auto two = two_sides(), first = two, second = two;
  first.plus.resize(2);
  first.minus.resize(1);
  second.plus.erase(second.plus.begin(), second.plus.begin() + 2);
  second.minus.erase(second.minus.begin());
  auto merged = first.tally();
  merged.merge(second.tally().pack());
  const auto a = merged.pack(), b = two.tally().pack();
  REQUIRE(a.size() == b.size());
  for (std::size_t n = 0; n < a.size(); ++n)
    CHECK(a[n] == Approx(b[n]).epsilon(1e-13).margin(1e-14));
  Tally again(kQuestion, process(1, -0.4));
  again.merge(b);
  CHECK(again.pack() == b);
}
