#include <boost/math/distributions/binomial.hpp>
#include <limits>
#include <numeric>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "stickslip/model/noise_chain.hpp"

using namespace stickslip::model;
using stickslip::test::relative_difference;

namespace {

NoiseChain full_chain(double tau, double delta) { return {tau, delta, full_range(tau, delta)}; }

}  // namespace

TEST_CASE("noise chain: jump probabilities are probabilities and mirror each other") {
  const NoiseChain chain = full_chain(1, 0.25);
  REQUIRE(chain.levels == 32);
  for (int i = -chain.levels; i <= chain.levels; ++i) {
    CHECK(chain.up(i) >= 0);
    CHECK(chain.up(i) + chain.down(i) == Approx(1).epsilon(1e-15));
    CHECK(chain.up(i) == chain.down(-i));
  }
  CHECK(chain.up(chain.levels) == 0);
  CHECK(chain.up(-chain.levels) == 1);
  CHECK(chain.up(0) == 0.5);
  CHECK(chain.up(4) == (1 - 0.25 * 1.0 / 2) / 2);
}

TEST_CASE("noise chain: the full range is 2/(tau delta^2), safe to rounding") {
  CHECK(full_range(1, 0.1) == 200);
  CHECK(full_range(1, 0.25) == 32);
  CHECK(full_range(0.7, 0.1) == 285);  // 285.71
  CHECK(full_range(1, 1.0 / 64) == 8192);
}

// Full range: X is an Ehrenfest urn of 2N balls, P(X = x_i) = C(2N, N+i)/4^N.
TEST_CASE("noise distribution: binomial on the full range, with relative accuracy in the tails") {
  const double delta = GENERATE(0.5, 0.25, 0.125);
  const NoiseChain chain = full_chain(1, delta);
  const int n = chain.levels;
  const boost::math::binomial_distribution<double> urn(2 * n, 0.5);
  const auto distribution = stationary_distribution(chain);
  for (int i = -n; i <= n; ++i) {
    CHECK(relative_difference(distribution[n + i], boost::math::pdf(urn, n + i)) < 1e-12);
  }
  CHECK(std::accumulate(distribution.begin(), distribution.end(), 0.0) == Approx(1).epsilon(1e-15));
}

TEST_CASE("noise distribution: detailed balance on a truncated range") {
  const NoiseChain chain{0.8, 0.2, 17};
  const auto distribution = stationary_distribution(chain);
  for (int i = -17; i < 17; ++i) {
    CHECK(relative_difference(distribution[17 + i] * chain.up(i),
                              distribution[18 + i] * chain.down(i + 1)) < 1e-14);
  }
}

TEST_CASE("noise moments: closed values, variance 1/tau on the full range") {
  CHECK(noise_moments(full_chain(1, 0.5), -2, 2).within == 51766.0 / 65536);
  // Printed in the paper for delta = 1/2 ... 1/32, right to about 13 digits.
  const double printed[] = {0.789886474609376, 0.739564523423343, 0.712010713468334,
                            0.697578849841333, 0.690192311713429};
  double delta = 1;
  for (double value : printed) {
    delta /= 2;
    const int k = static_cast<int>(1 / delta);
    const auto moments = noise_moments(full_chain(1, delta), -k, k);
    CHECK(relative_difference(moments.within, value) < 1e-13);
    CHECK(relative_difference(moments.square, 1) < 1e-14);
  }
  CHECK(relative_difference(noise_moments(full_chain(0.25, 0.5), -2, 2).square, 4) < 1e-14);
}

TEST_CASE("noise moments: far tails keep their relative accuracy") {
  const NoiseChain chain = full_chain(1, 0.25);
  const boost::math::binomial_distribution<double> urn(64, 0.5);
  for (int k : {8, 16, 24, 31}) {
    const double beyond = 2 * boost::math::cdf(boost::math::complement(urn, 32 + k));
    CHECK(relative_difference(noise_moments(chain, -k, k).beyond, beyond) < 1e-13);
  }
}

TEST_CASE("noise chain: a truncated range ends where it is truncated") {
  const NoiseChain chain{1, 0.25, 10};
  CHECK(chain.up(10) == 0);
  CHECK(chain.up(-10) == 1);
  CHECK(chain.up(9) > 0);
  CHECK(chain.up(-9) < 1);
}

TEST_CASE("noise chain: derivatives with respect to tau are differences at fixed levels") {
  const double h = 1e-5;
  const NoiseChain chain{1.5, 0.25, 10}, more{1.5 + h, 0.25, 10}, less{1.5 - h, 0.25, 10};
  for (int i = -10; i <= 10; ++i) {
    const double up = (more.up(i) - less.up(i)) / (2 * h);
    CHECK(chain.up_change(i) == Approx(up).epsilon(1e-9).margin(1e-11));
    CHECK(chain.down_change(i) == Approx(-up).epsilon(1e-9).margin(1e-11));
  }
  CHECK(chain.rate_change() == Approx((more.rate() - less.rate()) / (2 * h)).epsilon(1e-9));
}

// N = 100: a bulk of ten levels, and four operations beside it.
TEST_CASE("noise chain: rounding of sums grows with the width of the distribution") {
  const double unit = std::numeric_limits<double>::epsilon();
  CHECK(rounding_of_sums({1, 0.1, 100}) == Approx(14 * unit));
  CHECK(rounding_of_sums({1, 1, 1}) == Approx(5 * unit));
}
