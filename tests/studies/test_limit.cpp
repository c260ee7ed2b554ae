#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "stickslip/studies/limit.hpp"

using namespace stickslip::studies;

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
  const Limit limit = limit_of(smooth, order, false);
  CHECK(std::abs(limit.value - 1) < 1e-9);
  CHECK(std::abs(limit.value - 1) <= limit.error);
  CHECK(limit.error < 1e-7);
}

TEST_CASE("limit: half powers for mu_d = mu_s") {
  const auto grazing =
      samples_of([](double d) { return 2 + std::pow(d, 1.5) * (1 - std::sqrt(d)); }, 6);
  const double order = observed_order(grazing);
  const Limit limit = limit_of(grazing, order, true);
  CHECK(std::abs(limit.value - 2) <= limit.error);
  CHECK(limit.error < 1e-10);
  const auto second = samples_of([](double d) { return 2 + d * d * std::exp(std::sqrt(d)); }, 6);
  const Limit other = limit_of(second, observed_order(second), true);
  CHECK(std::abs(other.value - 2) <= other.error);
  CHECK(other.error < 1e-6);
}

TEST_CASE("limit: an unforeseen order stands for itself, and none gives no limit") {
  const auto cubic = samples_of([](double d) { return 1 + d * d * d; }, 5);
  const Limit limit = limit_of(cubic, observed_order(cubic), false);
  CHECK(limit.value == Approx(1).epsilon(1e-10));
  const auto uneven = samples_of([](double d) { return std::cos(60 / d); }, 3);
  CHECK(std::isnan(observed_order(uneven)));
  CHECK(std::isnan(limit_of(uneven, observed_order(uneven), false).value));
  CHECK(std::isnan(observed_order(samples_of([](double d) { return d; }, 2))));
}

TEST_CASE("limit: errors of the samples remain") {
  auto noisy = samples_of([](double d) { return std::exp(d); }, 5);
  for (auto& sample : noisy) sample.error = 1e-3;
  CHECK(limit_of(noisy, observed_order(noisy), false).error > 1e-3);
}
