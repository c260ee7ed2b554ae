#include <cmath>
#include <random>
#include <stdexcept>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "stickslip/linalg/dense.hpp"

using stickslip::linalg::LuFactors;
using stickslip::linalg::Matrix;
using stickslip::linalg::RateElimination;
using stickslip::test::relative_difference;

namespace {

struct Chain {
  std::vector<double> killing;
  std::vector<std::vector<double>> rate;
};

Chain random_chain(int count, int band, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-3, 3);
  Chain chain{{}, {static_cast<std::size_t>(count), std::vector<double>(count, 0.0)}};
  for (int i = 0; i < count; ++i) {
    chain.killing.push_back(std::exp(uniform(random)));
    for (int j = 0; j < count; ++j) {
      if (i != j && std::abs(i - j) <= band) chain.rate[i][j] = std::exp(uniform(random));
    }
  }
  return chain;
}

RateElimination factored(const Chain& chain, int band) {
  std::vector<RateElimination::Rate> rates;
  const int count = static_cast<int>(chain.killing.size());
  for (int i = 0; i < count; ++i) {
    for (int j = std::max(0, i - band); j <= std::min(count - 1, i + band); ++j) {
      if (i != j) rates.push_back({i, j, chain.rate[i][j]});
    }
  }
  return {chain.killing, rates};
}

// K - Q, or its transposed.
Matrix<double> dense(const Chain& chain, bool transposed) {
  const int count = static_cast<int>(chain.killing.size());
  Matrix<double> a(count, count);
  for (int i = 0; i < count; ++i) {
    a(i, i) += chain.killing[i];
    for (int j = 0; j < count; ++j) {
      a(i, i) += chain.rate[i][j];
      (transposed ? a(j, i) : a(i, j)) -= chain.rate[i][j];
    }
  }
  return a;
}

}  // namespace

TEST_CASE("rate elimination: solutions are those of Gaussian elimination, for every band") {
  const int count = 7;
  for (int band : {1, 2, 3, 6, 20}) {
    const Chain chain = random_chain(count, band, 5);
    const auto elimination = factored(chain, std::min(band, count - 1));
    std::vector<double> f, entry;
    for (int n = 0; n < count; ++n) {
      f.push_back(1 + n * n);
      entry.push_back(1.0 / (n + 1));
    }
    auto u = f, m = entry;
    LuFactors<double>(dense(chain, false)).solve(u, false);
    LuFactors<double>(dense(chain, true)).solve(m, false);
    const auto integral = elimination.integral(f), occupation = elimination.occupation(entry);
    for (int n = 0; n < count; ++n) {
      INFO("band " << band << " state " << n);
      CHECK(relative_difference(integral[n], u[n]) < 1e-12);
      CHECK(relative_difference(occupation[n], m[n]) < 1e-12);
    }
  }
}

// From state 0 the chain goes to 1 and back a hundred times for each time that it is killed there.
TEST_CASE("rate elimination: rare killing keeps every digit") {
  constexpr double rare = 1e-25;
  const RateElimination chain({0, rare}, {{0, 1, 2}, {1, 0, 3}});
  // By hand: u1 = (1 + 3 u0)/(3 + rare), u0 = 1/2 + u1.
  const auto time = chain.integral({1, 1});
  CHECK(relative_difference(time[1], 2.5 / rare) < 1e-15);
  const auto law = chain.occupation(std::vector<double>{1, 0});
  CHECK(relative_difference(law[1], 1 / rare) < 1e-15);
}

TEST_CASE("rate elimination: a cycle spends its time by the inverse rates") {
  const std::vector<double> rate{1, 10, 1e-12, 1e12};
  std::vector<RateElimination::Rate> steps;
  double total = 0;
  for (int n = 0; n < 4; ++n) {
    steps.push_back({n, (n + 1) % 4, rate[n]});
    total += 1 / rate[n];
  }
  const auto p = RateElimination(std::vector<double>(4, 0.0), steps).stationary();
  for (int n = 0; n < 4; ++n) CHECK(relative_difference(p[n], 1 / rate[n] / total) < 1e-15);
}

TEST_CASE("rate elimination: what is never left is refused") {
  CHECK_THROWS_AS(RateElimination({0, 0, 1}, {{1, 0, 1}}), std::invalid_argument);
  const RateElimination short_list({1, 1}, {});
  CHECK_THROWS_AS(short_list.integral({1}), std::invalid_argument);
  CHECK_THROWS_AS(short_list.occupation(std::vector<double>{1}), std::invalid_argument);
}
