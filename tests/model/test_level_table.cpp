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
