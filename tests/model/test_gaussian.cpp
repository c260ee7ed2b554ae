#include "stickslip/model/gaussian.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "../common/catch.hpp"
#include "../common/near.hpp"

using namespace stickslip;
using model::CovarianceTerm;
using model::GaussianNoise;
using test::relative_difference;

namespace {

constexpr model::Thresholds kSymmetric{{-1, 1}, {-0.5, 0.5}}, kTilted{{-1.2, 0.8}, {-0.7, 0.3}};

// A narrow band, one with a sine, and two and three Ornstein-Uhlenbeck processes.
const std::vector<std::vector<CovarianceTerm>> kNoises{{{1, 1}},
                                                       {{1, 0.5, 2}},
                                                       {{1, 1, 2, -0.3}},
                                                       {{1, 1}, {0.64, 5}},
                                                       {{0.5, 0.5}, {0.3, 2}, {0.2, 6}}};

model::NoiseChain chain_of(const GaussianNoise& noise, const model::Thresholds& thresholds,
                           int order) {
  return {.table = noise.projected(thresholds, order)};
}

}  // namespace

TEST_CASE("gaussian: the weights of the nodes are stationary, and those of the normal density") {
  for (const auto& terms : kNoises) {
    const GaussianNoise noise(terms);
    for (const auto& thresholds : {kSymmetric, kTilted}) {
      const auto chain = chain_of(noise, thresholds, 5);
      const auto p = model::stationary_distribution(chain);
      std::vector<double> left(p.size(), 0.0), size(p.size(), 0.0);
      double within = 0, square = 0;
      for (int i = chain.lowest(); i <= chain.highest(); ++i) {
        const auto n = static_cast<std::size_t>(i - chain.lowest());
        if (std::abs(chain.level(i)) <= 0.9) within += p[n];
        square += p[n] * chain.level(i) * chain.level(i);
        chain.for_each_jump(i, [&](int to, double rate) {
          const auto m = static_cast<std::size_t>(to - chain.lowest());
          left[n] -= p[n] * rate;
          left[m] += p[n] * rate;
          size[n] += p[n] * std::abs(rate);
          size[m] += p[n] * std::abs(rate);
        });
      }
      for (std::size_t n = 0; n < p.size(); ++n) CHECK(std::abs(left[n]) <= 1e-11 * size[n]);
      CHECK(relative_difference(square, noise.deviation() * noise.deviation()) < 1e-6);
      // A sum over nodes of a function with a jump, to the width of an element.
      CHECK(std::abs(within - std::erf(0.9 / noise.deviation() / std::numbers::sqrt2)) < 0.2);
    }
  }
}

TEST_CASE("gaussian: spectra of the nodes are those of the noise") {
  for (const auto& terms : kNoises) {
    const GaussianNoise noise(terms);
    const auto chain = chain_of(noise, kTilted, 6);
    for (double omega : {0.3, 1.0, 2.0, 5.0}) {
      CHECK(relative_difference(model::power_spectral_density(chain, omega),
                                noise.power_spectral_density(omega)) < 1e-6);
    }
  }
  const double omega = 1.7;
  CHECK(relative_difference(GaussianNoise({{2, 0.5}}).power_spectral_density(omega),
                            2 * 2 * 0.5 / (0.25 + omega * omega)) < 1e-14);
}

TEST_CASE("gaussian: with symmetry the nodes are their own mirror image") {
  const GaussianNoise band({{1, 0.5, 2}});
  CHECK(chain_of(band, kSymmetric, 4).even_in_order());
  CHECK_FALSE(chain_of(band, kTilted, 4).even());
  const auto table = band.projected(kSymmetric, 4);
  const auto mirrored = table->mirrored();
  double largest = 0;
  for (int i = table->lowest(); i <= table->highest(); ++i) {
    std::vector<double> here, there;
    table->for_each_jump(i, [&](int, double rate) { here.push_back(rate); });
    mirrored.for_each_jump(mirrored.lowest() + i - table->lowest(),
                           [&](int, double rate) { there.push_back(rate); });
    REQUIRE(here.size() == there.size());
    for (std::size_t n = 0; n < here.size(); ++n) {
      largest = std::max(largest, std::abs(here[n] - there[n]));
    }
  }
  CHECK(largest == 0);
}

TEST_CASE("gaussian: terms of one decay are one term") {
  const GaussianNoise one({{1, 1}}), two({{0.25, 1}, {0.75, 1}});
  const auto a = one.projected(kSymmetric, 4), b = two.projected(kSymmetric, 4);
  CHECK(a->highest() == b->highest());
}

TEST_CASE("gaussian: what is no covariance is refused, with the term") {
  const auto row = [](const std::vector<CovarianceTerm>& terms) {
    try {
      const GaussianNoise noise(terms);
    } catch (const model::UnfitTable& unfit) {
      return static_cast<int>(unfit.row());
    }
    return -1;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(row({{1, 1}, {1, -1}}) == 1);
  CHECK(row({{1, nan}}) == 0);
  CHECK(row({{1, 1, -2}}) == 0);
  CHECK(row({{1, 1}, {-1, 2}}) == 2);        // no variance
  CHECK(row({{1, 1}, {-0.9, 3}}) == 2);      // a negative spectrum
  CHECK(row({{1, 0.001, 5, 0.0001}}) == 1);  // paths that are too smooth
  CHECK(row({{1, 1}, {-0.1, 3}}) == -1);     // a negative amplitude may be one
}
