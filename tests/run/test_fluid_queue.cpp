#include <cmath>
#include <numeric>
#include <stdexcept>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "stickslip/run/routes.hpp"

using namespace stickslip;
using run::FluidQueue;
using test::relative_difference;

namespace {

model::Process without_drag(double delta, double mu_d) {
  return {{1, delta, model::full_range(1, delta)}, {1, mu_d}, {0, 0}};
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

// N = 1, k = 0, mu_d = 1/2, delta = 1: one rising phase, speed 1/2; two falling ones, speeds 1/2
// and 3/2; all jumps lead to 0 or away from it at rate 2. With p the probability that a sliding
// phase ends in phase 0 and q = 1 - p in phase -1 (a restart), the Riccati equation reads
//   4 - 4 p - 4 p + 4/3 q + 2 p^2 = 0  (to phase 0)  and  -4 q + 2 p - 4/3 q + 2 p q = 0  (to -1).
TEST_CASE("fluid queue: three phases satisfy their equations by hand") {
  const model::Process process{{1, 1, 1}, {0.5, 0.5}, {0, 0}};
  const FluidQueue queue(process);
  // Every sliding phase ends at rest in phase 0, after restarts in phase 1.
  CHECK(queue.plus().entry.size() == 1);
  CHECK(queue.plus().entry[0] == Approx(1).epsilon(1e-14));
  // Each restart turns the body round: q/p of them in the mean.
  const double turns = queue.plus().turns;
  const double q = turns / (1 + turns), p = 1 - q;
  CHECK(4 - 8 * p + 4 * q / 3 + 2 * p * p == Approx(0).margin(1e-13));
  CHECK(-4 * q + 2 * p - 4 * q / 3 + 2 * p * q == Approx(0).margin(1e-13));
}

TEST_CASE("fluid queue: sliding ends, and the noise keeps its distribution beyond mu_s") {
  for (double mu_d : {1.0, 0.5, 0.3, 0.25, 0.2500001, 0.05}) {
    const auto process = without_drag(0.25, mu_d);
    const FluidQueue queue(process);
    INFO("mu_d " << mu_d);
    CHECK(queue.residual() < 1e-14);
    CHECK(std::abs(sum(queue.plus().entry) - 1) < 1e-11);
    // Between two exits the noise spends pi(x_i) of the time on |x_i| > mu_s: ratios are known.
    const auto distribution = model::stationary_distribution(process.noise);
    const auto& time = queue.plus().slide_time;
    const auto at = [&](int i) { return time[32 + i] + time[32 - i]; };
    for (int i = 6; i <= 20; ++i) {
      CHECK(relative_difference(at(i) / at(5), distribution[32 + i] / distribution[37]) < 1e-10);
    }
  }
}

TEST_CASE("fluid queue: drag is refused") {
  CHECK_THROWS_AS(FluidQueue({{1, 0.5, 8}, {1, 1}, {1, 0}}), std::invalid_argument);
}

TEST_CASE("fluid queue: the residual is that of rounding, no less") {
  CHECK(FluidQueue(without_drag(0.25, 0.3)).residual() > 1e-18);
}
