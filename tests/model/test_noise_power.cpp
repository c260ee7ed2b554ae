#include <cmath>

#include "../common/chains.hpp"
#include "../common/given.hpp"
#include "../common/near.hpp"
#include "stickslip/model/noise_chain.hpp"

using namespace stickslip;
using test::relative_difference;
using test::scene_of;

TEST_CASE("noise power: that of a telegraph signal and of an Ornstein-Uhlenbeck chain") {
  const model::NoiseChain telegraph{1,
                                    1,
                                    1,
                                    {},
                                    std::make_shared<const model::LevelTable>(
                                        model::LevelTable({{-0.7, 0.4, 0}, {0.7, 0, 0.4}}))};
  // With all its levels this chain has the covariance of the process.
  const auto levels = scene_of({{"delta", "0.25"}, {"tau", "2"}, {"mu_d", "0.5"}});
  const auto urn = levels.meant().noise;
  for (double omega : {0.0, 1e-9, 0.3, 2.0, 50.0}) {
    CHECK(relative_difference(model::power_spectral_density(telegraph, omega),
                              0.49 * 4 * 0.4 / (0.64 + omega * omega)) < 1e-12);
    CHECK(relative_difference(model::power_spectral_density(urn, omega),
                              levels.noise.target(omega)) < 1e-10);
  }
}

TEST_CASE("noise power: chains with jumps of any length") {
  const auto table = std::make_shared<const model::LevelTable>(test::five_states());
  const model::NoiseChain chain{1, 1, 1, {}, table};
  CHECK(relative_difference(model::power_spectral_density(chain, 1e-6), 2 * table->intensity()) <
        1e-9);
  // Var X = (1/2 pi) int S_x, by the substitution omega = tan(u).
  double sum = 0;
  constexpr int count = 4000;
  for (int n = 0; n < count; ++n) {
    const double u = (n + 0.5) / count * std::acos(0.0), omega = std::tan(u);
    sum += model::power_spectral_density(chain, omega) * (1 + omega * omega) / count;
  }
  CHECK(relative_difference(sum / 2, table->variance()) < 1e-5);
}

TEST_CASE("noise power: that of a sum is the sum, where all of it is known") {
  const auto scene_with = [](const char* noise) {
    return scene_of({{"noise", noise},
                     {"pulse_height", "1"},
                     {"pulse_rate", "1"},
                     {"pulse_duration", "1"},
                     {"pulse_sign", "up"},
                     {"delta", "0.5"},
                     {"mu_d", "0.5"}});
  };
  CHECK(!scene_with("pulses+ou").noise.target);
  const auto alone = scene_with("pulses"), both = scene_with("pulses+ou");
  const auto added = [&](double omega) {
    return model::power_spectral_density(alone.meant().noise, omega) + 2 / (1 + omega * omega);
  };
  for (double omega : {0.5, 3.0}) {
    CHECK(relative_difference(model::power_spectral_density(both.meant().noise, omega),
                              added(omega)) < 1e-9);
  }
}

// Not that of the full range, 2; from a dense solve of the 11 levels.
TEST_CASE("noise power: at omega = 0 of a chain that ends early") {
  const model::NoiseChain chain{1, 0.25, 5};
  CHECK(model::power_spectral_density(chain, 0) == Approx(0.412457991464).epsilon(1e-11));
  CHECK(model::power_spectral_density(chain, 1e-7) == Approx(0.412457991464).epsilon(1e-11));
  CHECK(model::power_spectral_density(model::NoiseChain{1, 0.25, 32}, 0) ==
        Approx(2).epsilon(1e-13));
}
