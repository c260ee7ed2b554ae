#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/simulation/means.hpp"

using stickslip::simulation::Estimate;
using stickslip::simulation::PathBins;
using stickslip::simulation::Sampled;

namespace {

constexpr double kStep = 0.002;

PathBins bins_of(const std::vector<double>& sample) {
  PathBins bins(Sampled::one_side, true, 1, kStep);
  for (double y : sample) bins.add(0, false, 1, y);
  return bins;
}

}  // namespace

// The numbers below an end of the interval are those that 95 % of binomial counts lie between.
TEST_CASE("path bins: intervals of quantiles are those of order statistics") {
  std::vector<double> sample;
  for (int n = 1; n <= 1000; ++n) sample.push_back(n - 300.5);
  const auto bins = bins_of(sample);
  for (double p : {0.05, 0.2, 0.5, 0.9}) {
    const Estimate q = bins.quantile(p);
    const boost::math::binomial_distribution<> count(1000, p);
    INFO(p << ": " << q.value << " in " << q.low << ", " << q.high);
    CHECK(q.value == Approx(1000 * p - 300).margin(1.5));
    CHECK(q.low == Approx(boost::math::quantile(count, 0.025) - 300).margin(3));
    CHECK(q.high == Approx(boost::math::quantile(count, 0.975) - 300).margin(3));
  }
}

TEST_CASE("path bins: 90 to 99 of 100 intervals hold the quantile of a skewed distribution") {
  std::mt19937 random(7);
  std::exponential_distribution<double> draw(3);
  for (double p : {0.02, 0.5, 0.98}) {
    int held = 0;
    for (int repeat = 0; repeat < 100; ++repeat) {
      std::vector<double> sample(300);
      for (double& y : sample) y = draw(random) - 0.1;
      const Estimate q = bins_of(sample).quantile(p);
      const double known = -std::log1p(-p) / 3 - 0.1;
      if (q.low <= known && known <= q.high) ++held;
    }
    INFO(p << ": " << held);
    CHECK(held >= 90);
    CHECK(held <= 99);
  }
}

// Weights 5 and 1 in turn, of -1 and 2: a share of 5/6 below 0. Where y does not depend on them
// they count as 1000 (1 + 5)^2/(2 (1 + 25)) = 692 samples without weights.
TEST_CASE("path bins: weights count in shares and in intervals") {
  PathBins weighted(Sampled::one_side, true, 1, kStep), independent = weighted, even = weighted;
  for (int n = 0; n < 1000; ++n) {
    weighted.add(0, false, n % 2 == 0 ? 5 : 1, n % 2 == 0 ? -1 : 2);
    independent.add(0, false, n % 2 == 0 ? 5 : 1, n + 1);
    if (n < 692) even.add(0, false, 1, 1000.0 / 692 * (n + 1));
  }
  CHECK(weighted.quantile(0.7).value == Approx(-1).epsilon(kStep));
  CHECK(weighted.quantile(0.9).value == Approx(2).epsilon(kStep));
  for (double p : {0.2, 0.6}) {
    const Estimate one = independent.quantile(p), other = even.quantile(p);
    CHECK(one.value == Approx(1000 * p).epsilon(0.005));
    CHECK(one.high - one.low == Approx(other.high - other.low).epsilon(0.1));
  }
}

TEST_CASE("path bins: what has not moved is an exact 0, and few samples leave ends open") {
  std::vector<double> sample(60, 0);
  for (int n = 0; n < 20; ++n) sample.insert(sample.end(), {-1.0 - n, 1.0 + n});
  const auto bins = bins_of(sample);
  const Estimate middle = bins.quantile(0.5), low = bins.quantile(0.005),
                 high = bins.quantile(0.995);
  CHECK(middle.value == 0);
  CHECK(middle.low == 0);
  CHECK(middle.high == 0);
  CHECK(std::isinf(low.low));
  CHECK(low.value == Approx(-20).epsilon(kStep));
  CHECK(low.high < 0);
  CHECK(std::isinf(high.high));
  CHECK(high.value == Approx(20).epsilon(kStep));
}
