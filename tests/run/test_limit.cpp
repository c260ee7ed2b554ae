#include <cmath>
#include <span>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/run/study.hpp"

using namespace stickslip::run;

namespace {

std::vector<Sample> samples_of(double (*value)(double), int count) {
  std::vector<Sample> samples;
  for (int n = 0; n < count; ++n) {
    const double delta = 1 / (4 * std::pow(2.0, n) + 0.5);
    samples.push_back({delta, value(delta), 1e-14});
  }
  return samples;
}

}  // namespace

TEST_CASE("limit: powers of delta are removed one after the other") {
  const auto smooth = samples_of([](double d) { return std::exp(d); }, 6);
  const double order = observed_order(smooth);
  CHECK(order == Approx(1).margin(0.05));
  const auto limit = limit_of(smooth, order, false);
  CHECK(std::abs(limit.value - 1) < 1e-9);
  CHECK(std::abs(limit.value - 1) <= limit.error);
  CHECK(limit.error < 1e-7);
}

TEST_CASE("limit: half powers for mu_d = mu_s") {
  const auto grazing =
      samples_of([](double d) { return 2 + std::pow(d, 1.5) * (1 - std::sqrt(d)); }, 6);
  const double order = observed_order(grazing);
  const auto limit = limit_of(grazing, order, true);
  CHECK(std::abs(limit.value - 2) <= limit.error);
  CHECK(limit.error < 1e-10);
  const auto second = samples_of([](double d) { return 2 + d * d * std::exp(std::sqrt(d)); }, 6);
  const auto other = limit_of(second, observed_order(second), true);
  CHECK(std::abs(other.value - 2) <= other.error);
  CHECK(other.error < 1e-6);
}

TEST_CASE("limit: an unexpected order stands for itself, and none gives no limit") {
  const auto cubic = samples_of([](double d) { return 1 + d * d * d; }, 5);
  const auto limit = limit_of(cubic, observed_order(cubic), false);
  CHECK(limit.value == Approx(1).epsilon(1e-10));
  const auto uneven = samples_of([](double d) { return std::cos(60 / d); }, 3);
  CHECK(std::isnan(observed_order(uneven)));
  CHECK(std::isnan(limit_of(uneven, observed_order(uneven), false).value));
  CHECK(std::isnan(observed_order(samples_of([](double d) { return d; }, 2))));
}

// On a straight line, two samples at delta and delta/2 extrapolate to 2 v(delta/2) - v(delta).
TEST_CASE("limit: errors of the samples count by the size of their weights") {
  const std::vector<Sample> line{{0.5, 1.5, 1e-3}, {0.25, 1.25, 1e-3}, {0.125, 1.125, 2e-3}};
  const auto limit = limit_of(line, 1, false);
  CHECK(limit.value == Approx(1).epsilon(1e-12));
  CHECK(limit.error == Approx(2 * 2e-3 + 1e-3).epsilon(1e-9));
}

// Two samples at delta and delta/2, and the two before: 1 + delta + delta^2.
TEST_CASE("limit: the error holds the change that the last sample makes") {
  const std::vector<Sample> curve{{0.5, 1.75, 0}, {0.25, 1.3125, 0}, {0.125, 1.140625, 0}};
  const auto limit = limit_of(curve, 1, false);
  const double now = 2 * 1.140625 - 1.3125, before = 2 * 1.3125 - 1.75;
  CHECK(limit.value == Approx(now).epsilon(1e-12));
  CHECK(limit.error == Approx(now - before).epsilon(1e-12));
}

TEST_CASE("limit: by an observed order, the error is the change from one limit to the next") {
  const auto samples = samples_of([](double d) { return 1 + d * d * d * (1 + d); }, 5);
  const auto limit = limit_of(samples, observed_order(samples), false);
  const auto shorter = std::span(samples).first(4);
  const auto before = limit_of(shorter, observed_order(shorter), false);
  CHECK(std::abs(limit.value - 1) < 1e-5);
  CHECK(limit.error == Approx(std::abs(limit.value - before.value)).epsilon(1e-12));
  CHECK(limit.error > std::abs(limit.value - 1));
}

TEST_CASE("limit: changes of opposite signs have no order, and steep ones have") {
  const std::vector<Sample> alternating{{0.5, 1, 0}, {0.25, 2, 0}, {0.125, 1.5, 0}};
  CHECK(std::isnan(observed_order(alternating)));
  for (double power : {0.5, 1.0, 2.0, 3.5, 6.0}) {
    const std::vector<Sample> pure{{0.5, std::pow(0.5, power), 0},
                                   {0.25, std::pow(0.25, power), 0},
                                   {0.1, std::pow(0.1, power), 0}};
    CHECK(observed_order(pure) == Approx(power).epsilon(1e-9));
  }
}

TEST_CASE("limit: errors of the samples remain") {
  auto noisy = samples_of([](double d) { return std::exp(d); }, 5);
  for (auto& sample : noisy) sample.error = 1e-3;
  CHECK(limit_of(noisy, observed_order(noisy), false).error > 1e-3);
}

TEST_CASE("limit: half powers of tau, whichever of them are there") {
  for (auto value : {+[](double t) { return std::exp(std::sqrt(t)); },
                     +[](double t) { return 1 + t * std::exp(std::sqrt(t)); },
                     +[](double t) { return 1 / (1 + t); }}) {
    std::vector<Sample> falling;
    for (int n = 0; n < 6; ++n) {
      const double tau = std::pow(4.0, -n - 1);
      falling.push_back({tau, value(tau), 1e-14});
    }
    const auto limit = limit_in_half_powers(falling);
    CHECK(std::abs(limit.value - 1) <= limit.error);
    CHECK(limit.error < 1e-4);
  }
}

// Through 1/4, 1/16 and their values, u + C tau^(1/2) is 2 v(1/16) - v(1/4).
TEST_CASE("limit: in half powers, the error holds the change that the last power makes") {
  const std::vector<Sample> curve{{1, 4, 0}, {0.25, 2, 0}, {0.0625, 1.25, 0}};
  const auto limit = limit_in_half_powers(curve);
  CHECK(limit.value == Approx(2 * 1.25 - 2).epsilon(1e-12));
  // Without the last sample it is 0, without the last power 1.25.
  CHECK(limit.error == Approx(0.75).epsilon(1e-12));
}

// Mean first passage of |V| = 1/2 without drag, mu_d = 1, at tau = 4^-2 ... 4^-7; three steps more
// give 0.1487212707. Through the last five, leaving one out changes 1e-7 by chance.
TEST_CASE("limit: in half powers, changes that are small by chance do not make the error") {
  std::vector<Sample> falling;
  for (double value : {0.56077888600, 0.305042142954, 0.216337451392, 0.180180502742,
                       0.1639024571187, 0.1561793640515}) {
    falling.push_back({std::ldexp(0.0625, -2 * static_cast<int>(falling.size())), value, 1e-12});
  }
  const auto limit = limit_in_half_powers(falling);
  CHECK(std::abs(limit.value - 0.1487212707) <= limit.error);
  CHECK(limit.error < 1e-5);
}

TEST_CASE("limit: what grows as tau falls has none, nor an order within its errors") {
  const std::vector<Sample> growing{{1, 1, 0}, {0.25, 4, 0}, {0.0625, 16, 0}};
  CHECK(std::isnan(limit_in_half_powers(growing).value));
  const std::vector<Sample> uncertain{{1, 4, 1}, {0.25, 2, 1}, {0.0625, 1, 1}};
  CHECK(std::isnan(observed_order(uncertain)));
}
