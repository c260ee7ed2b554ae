#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numeric>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "stickslip/generator/static_chain.hpp"

using namespace stickslip;
using generator::StaticChain;
using test::relative_difference;
using Big = boost::multiprecision::cpp_bin_float_100;

namespace {

// m (lambda - Q) = entry by Gaussian elimination on diagonals in 100 digits: another algorithm,
// precise enough to be exact here.
std::vector<double> exact_occupation(const model::NoiseChain& chain, int k, double lambda,
                                     const std::vector<double>& entry) {
  const int n = 2 * k + 1;
  std::vector<Big> up(n), down(n), diagonal(n), m(n);
  const Big rate = 2 / (Big(chain.tau) * chain.delta * chain.tau * chain.delta);
  for (int r = 0; r < n; ++r) {
    const Big tilt = Big(chain.tau) * chain.delta * chain.delta * (r - k) / 2;
    up[r] = rate * (1 - tilt) / 2;
    down[r] = rate * (1 + tilt) / 2;
    diagonal[r] = Big(lambda) + rate;
    m[r] = entry[r];
  }
  for (int r = 1; r < n; ++r) {
    const Big factor = up[r - 1] / diagonal[r - 1];
    diagonal[r] -= factor * down[r];
    m[r] += factor * m[r - 1];
  }
  m[n - 1] /= diagonal[n - 1];
  for (int r = n - 2; r >= 0; --r) m[r] = (m[r] + down[r + 1] * m[r + 1]) / diagonal[r];
  std::vector<double> result;
  for (const Big& value : m) result.push_back(value.convert_to<double>());
  return result;
}

std::vector<double> entry_law(int k) {
  std::vector<double> entry;
  for (int i = -k; i <= k; ++i) entry.push_back(1.0 / (3 + std::abs(i)));
  const double total = std::accumulate(entry.begin(), entry.end(), 0.0);
  for (double& p : entry) p /= total;
  return entry;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

TEST_CASE("static chain: one level sticks for 1/Lambda") {
  const model::NoiseChain chain{1, 0.5, 8};
  const StaticChain one(chain, 0);
  CHECK(one.occupation(std::vector<double>{1.0})[0] == Approx(1 / chain.rate()).epsilon(1e-15));
  CHECK(one.exit_transform()[0] == Approx(1).epsilon(1e-15));
}

// Three levels by hand: from 0 the walk goes to +-1 and leaves from there with probability
// alpha_1, so it makes 1/alpha_1 rounds: 1/alpha_1 visits to 0, as many to +-1 together.
TEST_CASE("static chain: three levels by hand") {
  const model::NoiseChain chain{1, 0.5, 8};
  const auto m = StaticChain(chain, 1).occupation(std::vector<double>{0, 1, 0});
  const double rounds = 1 / chain.up(1);
  CHECK(m[1] == Approx(rounds / chain.rate()).epsilon(1e-15));
  CHECK(m[0] + m[2] == Approx(rounds / chain.rate()).epsilon(1e-15));
}

TEST_CASE("static chain: full relative accuracy of every entry at any time scale") {
  struct Case {
    double tau, delta, mu_s, lambda;
  };
  for (const auto& c : {Case{1, 0.25, 1, 0}, Case{1, 0.25, 6, 0}, Case{1, 0.125, 9.5, 0},
                        Case{1, 0.125, 9.5, 1e-14}, Case{4, 0.25, 1, 0}, Case{1, 0.25, 6, 3.7},
                        Case{1, 0.25, 3, 1e12}}) {
    const model::NoiseChain chain{c.tau, c.delta, model::full_range(c.tau, c.delta)};
    const int k = static_cast<int>(c.mu_s / c.delta);
    const auto entry = entry_law(k);
    const auto m = StaticChain(chain, k, c.lambda).occupation(entry);
    const auto exact = exact_occupation(chain, k, c.lambda, entry);
    for (std::size_t r = 0; r < m.size(); ++r) CHECK(relative_difference(m[r], exact[r]) < 1e-13);
    INFO("mean sticking time " << sum(m));
    CHECK(sum(m) > 0);
  }
}

TEST_CASE("static chain: mean sticking times of 1e20 are ordinary") {
  const model::NoiseChain chain{1, 0.125, 128};
  const int k = 77;  // 9.6 standard deviations
  const double mean = sum(StaticChain(chain, k).occupation(entry_law(k)));
  CHECK(mean > 1e18);
  CHECK(relative_difference(mean, sum(exact_occupation(chain, k, 0, entry_law(k)))) < 1e-13);
}

// (1 - E[exp(-lambda T)])/lambda = discounted occupation summed over the chain.
TEST_CASE("static chain: transform and occupation agree") {
  const model::NoiseChain chain{1, 0.25, 32};
  const int k = 4;
  for (double lambda : {1e-3, 0.3, 1.0, 40.0}) {
    const StaticChain killed(chain, k, lambda);
    const auto transform = killed.exit_transform();
    for (int start = 0; start <= 2 * k; ++start) {
      std::vector<double> entry(2 * k + 1, 0.0);
      entry[start] = 1;
      CHECK(1 - lambda * sum(killed.occupation(entry)) == Approx(transform[start]).epsilon(1e-12));
    }
  }
}

TEST_CASE("static chain: refuses levels beyond the noise and negative lambda") {
  const model::NoiseChain chain{1, 0.5, 8};
  CHECK_THROWS_AS(StaticChain(chain, 8), std::invalid_argument);
  CHECK_THROWS_AS(StaticChain(chain, -1), std::invalid_argument);
  CHECK_THROWS_AS(StaticChain(chain, 2, -1), std::invalid_argument);
  CHECK_THROWS_AS(StaticChain(chain, 2).occupation(std::vector<double>{1}), std::invalid_argument);
}

// An odd function vanishes at 0 and is fixed by its values above: the chain on 1 ... k killed at 0
// gives the difference of leaving upwards and downwards, which the full chain gives by subtraction.
TEST_CASE("static chain: the odd chain is the odd part of the full one") {
  const model::NoiseChain chain{1, 0.25, 32};
  const int k = 5;
  for (double lambda : {0.0, 0.4, 30.0}) {
    const auto odd = StaticChain::odd(chain, k, lambda).upward_exit_transform();
    const auto upwards = StaticChain(chain, k, lambda).upward_exit_transform();
    const auto both = StaticChain(chain, k, lambda).exit_transform();
    REQUIRE(odd.size() == 5);
    for (int i = 1; i <= k; ++i) {
      CHECK(odd[i - 1] == Approx(upwards[k + i] - upwards[k - i]).epsilon(1e-12));
      CHECK(both[k + i] == Approx(upwards[k + i] + upwards[k - i]).epsilon(1e-13));
    }
  }
  CHECK(StaticChain::odd(chain, 0).upward_exit_transform().empty());
}

TEST_CASE("static chain: integrals and occupations are adjoint") {
  const model::NoiseChain chain{1, 0.25, 32};
  const StaticChain sticking(chain, 4, 0.3);
  std::vector<double> f, entry = entry_law(4);
  for (int i = -4; i <= 4; ++i) f.push_back(1 + 0.1 * i * i);
  const auto m = sticking.occupation(entry);
  const auto u = sticking.integral(f);
  const double left = std::inner_product(m.begin(), m.end(), f.begin(), 0.0);
  const double right = std::inner_product(entry.begin(), entry.end(), u.begin(), 0.0);
  CHECK(left == Approx(right).epsilon(1e-14));
}
