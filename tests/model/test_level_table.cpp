#include <cmath>
#include <limits>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/process.hpp"

using namespace stickslip::model;
using stickslip::test::relative_difference;

namespace {

/// A chain as a table, moved by `shift`.
LevelTable tabulated(const NoiseChain& chain, double shift = 0) {
  std::vector<Level> levels;
  for (int i = chain.lowest(); i <= chain.highest(); ++i) {
    levels.push_back({chain.level(i) + shift, chain.up_rate(i), chain.down_rate(i)});
  }
  return LevelTable(levels);
}

NoiseChain of(LevelTable table) {
  NoiseChain chain;
  chain.table = std::make_shared<const LevelTable>(std::move(table));
  return chain;
}

std::size_t unfit_row(const std::vector<Level>& levels) {
  try {
    const LevelTable table(levels);
  } catch (const UnfitTable& unfit) {
    return unfit.row();
  }
  return std::numeric_limits<std::size_t>::max();
}

}  // namespace

TEST_CASE("level table: what is no chain is refused with its row") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(unfit_row({}) == 0);
  CHECK(unfit_row({{0, 0, 0}}) == 0);
  CHECK(unfit_row({{0, 1, 0}, {0, 0, 1}}) == 1);
  CHECK(unfit_row({{0, 1, 0}, {-1, 1, 1}, {2, 0, 1}}) == 1);
  CHECK(unfit_row({{0, 1, 0}, {nan, 0, 1}}) == 1);
  CHECK(unfit_row({{0, 0, 0}, {1, 0, 1}}) == 0);  // never left
  CHECK(unfit_row({{0, 1, 0}, {1, 0, 0}}) == 1);  // never left
  CHECK(unfit_row({{0, 1, 0}, {1, -1, 1}, {2, 0, 1}}) == 1);
  CHECK(unfit_row({{0, 1, 0.5}, {1, 0, 1}}) == 0);  // leads to nowhere
  CHECK(unfit_row({{0, 1, 0}, {1, 2, 1}}) == 1);
  CHECK(unfit_row({{-1, 1, 0}, {1, 0, 3}}) > 2);
}

TEST_CASE("level table: two values, by their closed forms") {
  const LevelTable telegraph({{-2, 3, 0}, {1, 0, 1}});  // probabilities 1/4 and 3/4
  CHECK(telegraph.mean() == Approx(0.25).epsilon(1e-14));
  CHECK(telegraph.variance() == Approx(9 * 3.0 / 16).epsilon(1e-14));
  // Correlations fall like exp(-(3 + 1) t).
  CHECK(telegraph.intensity() == Approx(27.0 / 64).epsilon(1e-14));
  CHECK(telegraph.rate() == 3);
  CHECK(telegraph.step() == 3);
  CHECK(telegraph.lowest() == -1);
  CHECK(telegraph.mode() == 0);
  CHECK_FALSE(telegraph.even());
  const LevelTable pair({{-1, 2, 0}, {1, 0, 2}});
  CHECK(pair.even());
  CHECK_FALSE(pair.symmetric());
  const LevelTable mirrored = telegraph.mirrored();
  CHECK(mirrored.lowest() == 0);
  CHECK(mirrored.at(0).x == -1);
  CHECK(mirrored.at(0).up == 1);
  CHECK(mirrored.at(1).x == 2);
  CHECK(mirrored.at(1).down == 3);
  CHECK(mirrored.intensity() == Approx(telegraph.intensity()).epsilon(1e-14));
}

TEST_CASE("level table: an Ornstein-Uhlenbeck chain level by level is the same chain") {
  for (const NoiseChain& chain :
       {NoiseChain{1, 0.25, 32}, NoiseChain{0.5, 0.3, 44}, NoiseChain{2, 0.125, 60, 0.8}}) {
    const NoiseChain table = of(tabulated(chain));
    CHECK(table.lowest() == chain.lowest());
    CHECK(table.symmetric());
    CHECK(table.rate() == Approx(chain.rate()).epsilon(1e-14));
    CHECK(table.step() == Approx(chain.step()).epsilon(1e-13));
    if (chain.levels == full_range(chain.tau, chain.delta, chain.deviation)) {
      CHECK(table.standard_deviation() == Approx(chain.standard_deviation()).epsilon(1e-13));
      CHECK(table.intensity() == Approx(chain.intensity()).epsilon(1e-12));
      CHECK(table.correlation_time() == Approx(chain.tau).epsilon(1e-12));
    }
    const auto p = stationary_distribution(chain), q = stationary_distribution(table);
    for (std::size_t n = 0; n < p.size(); ++n) CHECK(relative_difference(p[n], q[n]) < 1e-12);
    for (double x : {-0.9, -0.25, 0.0, 0.3, 1.0, 1.01}) {
      CHECK(table.last_up_to(x) == chain.last_up_to(x));
      CHECK(table.first_from(x) == chain.first_from(x));
      CHECK(table.place(x) == Approx(chain.place(x)).margin(1e-12));
      CHECK(table.find(x).has_value() == chain.find(x).has_value());
    }
    const auto here = noise_moments(chain, -2, 3), there = noise_moments(table, -2, 3);
    CHECK(relative_difference(here.within, there.within) < 1e-13);
    CHECK(relative_difference(here.beyond, there.beyond) < 1e-13);
    CHECK(relative_difference(here.square, there.square) < 1e-13);
  }
}

TEST_CASE("level table: beyond its ends there is nothing") {
  const NoiseChain table = of(LevelTable({{-1, 1, 0}, {0.5, 1, 2}, {4, 0, 1}}));
  CHECK(table.last_up_to(-3) == -2);
  CHECK(table.last_up_to(9) == 1);
  CHECK(table.first_from(5) == 2);
  CHECK(table.first_from(-5) == -1);
  CHECK_FALSE(table.find(1));
  CHECK(table.find(4) == 1);
  CHECK(table.place(2.25) == Approx(0.5));
  CHECK(table.mirrored().mirrored().level(1) == 4);
}

// Where observables are looked at is found by places.
TEST_CASE("level table: places go on beyond ends that several states share") {
  const NoiseChain table = of(LevelTable(
      {-1, -1, 0, 2, 2, 2}, {{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {3, 4, 1}, {4, 5, 1}, {5, 0, 1}}));
  const int low = table.lowest(), high = table.highest();
  CHECK(table.place(2) == Approx(high));
  CHECK(table.place(4) == Approx(high + 3));
  CHECK(table.place(1) == Approx(high - 2.5));
  CHECK(table.place(-1.5) == Approx(low - 1));
}

TEST_CASE("level table: far tails count in the intensity as they should") {
  // An urn whose tails are 1e-300: sums from the wrong end would be rounding over next to nothing.
  const NoiseChain urn{1, 1.0 / 16, 512};
  CHECK(of(tabulated(urn, 0.3)).intensity() == Approx(1).epsilon(1e-11));
}

TEST_CASE("process: a table that ends at the levels that stick is left on one side") {
  Process process{of(LevelTable({{-1, 1, 0}, {1, 0, 1}})), {1, 0.5}, {}, 0.3};
  CHECK(process.highest_static() == -1);
  CHECK(process.lowest_static() == -1);
  CHECK(process.starts_upwards());
  CHECK_FALSE(process.starts_downwards());
  CHECK(process.mirrored().starts_downwards());
  CHECK_FALSE(process.mirrored().starts_upwards());
  CHECK(process.mirrored().net_force(1) == Approx(1 - 0.3 - 0.5));
}

namespace {

/// Levels of the sum of two independent telegraph signals.
LevelTable two_telegraphs(double a, double b, double of_a, double of_b) {
  return {{-a - b, a - b, b - a, a + b},
          {{0, 1, of_a},
           {1, 0, of_a},
           {2, 3, of_a},
           {3, 2, of_a},
           {0, 2, of_b},
           {2, 0, of_b},
           {1, 3, of_b},
           {3, 1, of_b}}};
}

}  // namespace

TEST_CASE("level table: levels of a part keep their numbers in the list") {
  const LevelTable table({0, -1, -2, -3},
                         {{0, 1, 1}, {1, 0, 2}, {1, 2, 1}, {2, 1, 3}, {2, 3, 1}, {3, 2, 4}});
  REQUIRE(table.neighbours_only());
  const LevelTable part = table.within(-2, -1);
  CHECK(part.listed(-2) == 2);
  CHECK(part.listed(-1) == 1);
}

TEST_CASE("level table: jumps of any length are known by level, in rising order of x") {
  const LevelTable table({0.5, -1, 2}, {{0, 1, 3}, {1, 2, 5}, {2, 0, 7}, {1, 0, 11}});
  REQUIRE_FALSE(table.neighbours_only());
  CHECK(table.at(table.lowest()).x == -1);
  CHECK(table.listed(table.highest()) == 2);
  CHECK(table.at(table.lowest()).up == 16);
  CHECK(table.at(table.highest()).down == 7);
  std::vector<std::pair<int, double>> from_lowest;
  table.for_each_jump(table.lowest(),
                      [&](int to, double rate) { from_lowest.emplace_back(to, rate); });
  CHECK(from_lowest ==
        std::vector<std::pair<int, double>>{{table.lowest() + 1, 11}, {table.lowest() + 2, 5}});
  // By hand: flows 3 p0 = 11 p1 + 7 p2, 16 p1 = 3 p0, 7 p2 = 5 p1.
  const double p1 = 3 / (16 + 3 + 15.0 / 7);
  CHECK(relative_difference(stationary_distribution(of(table))[0], p1) < 1e-15);
}

TEST_CASE("level table: neighbours given as transitions are the chain of neighbours, bit for bit") {
  const NoiseChain chain{1, 0.5, 6};
  const LevelTable known = tabulated(chain);
  std::vector<double> x;
  std::vector<Transition> transitions;
  for (int i = 6; i >= -6; --i) x.push_back(chain.level(i));  // falling
  for (int i = -6; i < 6; ++i) {
    const auto place = [](int level) { return static_cast<std::size_t>(6 - level); };
    transitions.push_back({place(i), place(i + 1), chain.up_rate(i)});
    transitions.push_back({place(i + 1), place(i), chain.down_rate(i + 1)});
  }
  const LevelTable table(x, transitions);
  REQUIRE(table.neighbours_only());
  CHECK(table.symmetric());
  CHECK(table.variance() == known.variance());
  CHECK(table.intensity() == known.intensity());
  CHECK(table.upper_tail() == known.upper_tail());
}

// Correlations fall like exp(-2 rate t).
TEST_CASE("level table: a sum of telegraph signals has the sums of their moments") {
  const LevelTable table = two_telegraphs(1, 0.25, 2, 0.1);
  REQUIRE_FALSE(table.neighbours_only());
  CHECK(table.even());
  CHECK(table.mean() == 0);
  CHECK(relative_difference(table.variance(), 1 + 1 / 16.0) < 1e-15);
  CHECK(relative_difference(table.intensity(), 1 / 4.0 + 1 / 16.0 / 0.2) < 1e-13);
  CHECK(table.upper_tail() >= table.intensity());
  CHECK(table.upper_tail() == table.mirrored().upper_tail());
}

// A rotation through n phases at the rate r each has the eigenvalues r (1 - exp(2 pi i k/n)), and
// its correlation by phases cos is Re exp(-r (1 - exp(2 pi i/n)) t)/2.
TEST_CASE("level table: a narrow band counts by its largest strength, not by that at frequency 0") {
  constexpr int n = 24;
  constexpr double r = 24, pi = 3.141592653589793;
  std::vector<double> x;
  std::vector<Transition> transitions;
  for (std::size_t k = 0; k < n; ++k) {
    x.push_back(std::cos(2 * pi * static_cast<double>(k) / n));
    transitions.push_back({k, (k + 1) % n, r});
  }
  const LevelTable table(x, transitions);
  const double damping = r * (1 - std::cos(2 * pi / n)), omega = r * std::sin(2 * pi / n);
  CHECK(table.even());
  CHECK(relative_difference(table.variance(), 0.5) < 1e-13);
  CHECK(relative_difference(table.intensity(),
                            0.5 * damping / (damping * damping + omega * omega)) < 1e-11);
  // At omega: (1/(damping) + damping/(damping^2 + 4 omega^2))/4.
  const double peak = (1 / damping + damping / (damping * damping + 4 * omega * omega)) / 4;
  CHECK(table.upper_tail() > 0.9 * peak);
}

TEST_CASE("level table: an image in the mirror is found among states of one x, however numbered") {
  // Two states at each of -1 and 1, and two at 0; the mirror exchanges "fast" and "slow" ones.
  const std::vector<double> x{1, 0, -1, 0, 1, -1};
  const std::vector<Transition> transitions{{0, 1, 2}, {1, 0, 3}, {5, 3, 2}, {3, 5, 3},
                                            {4, 3, 5}, {3, 4, 7}, {2, 1, 5}, {1, 2, 7}};
  auto connected = transitions;
  connected.push_back({1, 3, 0.5});
  connected.push_back({3, 1, 0.5});
  CHECK(LevelTable(x, connected).even());
  connected.back().rate = 0.6;
  CHECK_FALSE(LevelTable(x, connected).even());
  // Numbers of other programs have rounding.
  auto rounded = x;
  rounded[1] = 1e-16;
  rounded[0] = 1 + 2e-16;
  connected.back().rate = 0.5 * (1 + 4e-16);
  const LevelTable table(rounded, connected);
  CHECK(table.even());
  CHECK(table.step() == Approx(1));
}

TEST_CASE("level table: states of one x keep their order, whatever the units") {
  std::vector<double> x{0.1, 0.1, -0.9, -0.8, -2, 1.2, -0.9, 0.1};
  std::vector<Transition> transitions{{0, 1, 0.3}, {1, 2, 4.1}, {2, 3, 4.9}, {3, 4, 0.5},
                                      {4, 5, 2.7}, {5, 6, 1.1}, {6, 7, 0.8}, {7, 0, 0.4},
                                      {0, 4, 0.1}, {3, 0, 1.8}, {1, 5, 2}};
  for (int unit = 0; unit < 12; ++unit) {
    const LevelTable table(x, transitions);
    std::vector<std::size_t> order;
    for (int i = table.lowest(); i <= table.highest(); ++i) order.push_back(table.listed(i));
    CHECK(order == std::vector<std::size_t>{4, 2, 6, 3, 0, 1, 7, 5});
    for (double& force : x) force *= 1e-3;
    for (auto& transition : transitions) transition.rate *= 7;
  }
}

TEST_CASE("level table: states that do not all reach one another are refused by their number") {
  const auto unfit = [](const std::vector<double>& x, const std::vector<Transition>& transitions) {
    try {
      const LevelTable table(x, transitions);
    } catch (const UnfitTable& problem) {
      return std::pair{problem.row(), std::string(problem.what())};
    }
    return std::pair{std::size_t{99}, std::string()};
  };
  using Catch::Contains;
  const std::vector<double> x{-1, 0, 1, 2};
  CHECK_THAT(unfit(x, {{0, 1, 1}, {1, 0, 1}, {1, 2, 1}, {2, 1, 1}, {3, 1, 1}}).second,
             Contains("state 3 is never reached"));
  CHECK_THAT(unfit(x, {{0, 1, 1}, {1, 0, 1}, {1, 2, 1}, {2, 1, 1}, {1, 3, 1}}).second,
             Contains("state 3 is never left"));
  CHECK(unfit(x, {{0, 1, 1}, {1, 0, 1}, {2, 3, 1}, {3, 2, 1}}).first == 2);
  CHECK_THAT(unfit(x, {{0, 1, 1}, {1, 0, 1}, {2, 3, 1}, {3, 2, 1}, {2, 0, 1}}).second,
             Contains("state 2 is never reached from state 0"));
  CHECK_THAT(unfit(x, {{0, 1, 1}, {1, 0, 1}, {2, 3, 1}, {3, 2, 1}, {0, 2, 1}}).second,
             Contains("state 0 is never reached from state 2"));
  CHECK(unfit({0, 1}, {{0, 1, -1}, {1, 0, 1}}).first == 0);
}
