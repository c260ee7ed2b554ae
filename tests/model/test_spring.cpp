#include "stickslip/model/spring.hpp"

#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/model/process.hpp"

using namespace stickslip;
using model::NoiseChain;
using model::Spring;

namespace {

const Spring::Body kBody{2, 0.6, {1, 0.5}, {}};

NoiseChain telegraph() {
  return {.table = std::make_shared<const model::LevelTable>(
              std::vector<model::Level>{{-1.5, 0.5, 0}, {1.5, 0, 0.5}})};
}

// What a motion upwards makes of a function of the nodes, per distance.
template <class Function>
double carried(const NoiseChain& chain, int i, Function f) {
  double sum = 0;
  chain.for_each_carried(i, [&](int to, double rate) { sum += rate * (f(to) - f(i)); });
  return sum;
}

}  // namespace

TEST_CASE("spring: force, noise and position belong together, and motion changes them") {
  constexpr model::Thresholds thresholds{{-1, 1}, {-0.5, 0.5}};
  const Spring coloured(kBody, Spring::Coloured{1, 1}), levels(kBody, telegraph());
  for (const auto* spring : {&coloured, &levels}) {
    const NoiseChain chain{.table = spring->projected(thresholds, 4)};
    CHECK(chain.even_in_order());
    CHECK_FALSE(chain.has_levels());
    CHECK(chain.continuous() == (spring == &coloured));
    const NoiseChain mirrored = chain.mirrored();
    double largest = 0, apart = 0;
    for (int i = chain.lowest(); i <= chain.highest(); ++i) {
      const double f = chain.noise(i) - 2 * chain.position(i) + 0.6;
      CHECK(std::abs(chain.level(i) - f) < 1e-8);
      CHECK(chain.noise(i) == -mirrored.noise(-i));
      const double step = carried(chain, i, [&](int n) { return chain.position(n); });
      largest = std::max(largest, std::abs(step - 1));
      const int there = i - chain.lowest() + mirrored.lowest();
      const double same = carried(mirrored, there, [&](int n) { return mirrored.level(n); });
      apart = std::max(apart,
                       std::abs(same - carried(chain, i, [&](int n) { return chain.level(n); })));
    }
    // Polynomials are exact but at the ends of bounded positions.
    if (spring == &coloured) CHECK(largest < 1e-10);
    CHECK(apart < 1e-9);
  }
}

TEST_CASE("spring: levels that hold the body at some position have no stationary state") {
  const NoiseChain weak{.table = std::make_shared<const model::LevelTable>(
                            std::vector<model::Level>{{-0.9, 1, 0}, {0.9, 0, 1}})};
  CHECK_THROWS_AS(Spring(kBody, weak), model::UnfitTable);
}
