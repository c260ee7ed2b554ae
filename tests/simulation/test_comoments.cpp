#include <algorithm>
#include <cmath>
#include <random>

#include "../common/catch.hpp"
#include "stickslip/simulation/means.hpp"

using stickslip::simulation::Comoments;

namespace {

using Samples = std::vector<std::vector<double>>;

Samples samples(int count, double offset, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  Samples all;
  for (int n = 0; n < count; ++n) {
    const double a = uniform(), b = a * a + uniform(), c = -3 * a + b * uniform();
    all.push_back({offset + a, b, -offset + c});
  }
  return all;
}

Comoments of(const Samples& all, std::size_t begin, std::size_t end) {
  Comoments c(3);
  for (std::size_t n = begin; n < end; ++n) c.add(all[n]);
  return c;
}

const std::vector<double> kWeight{0.7, -2, 1.5};

/// By two passes in long double.
struct TwoPass {
  std::vector<long double> mean = std::vector<long double>(3);
  long double variance_of_mean = 0;

  explicit TwoPass(const Samples& all) {
    const auto n = static_cast<long double>(all.size());
    for (const auto& s : all) {
      for (std::size_t m = 0; m < 3; ++m) mean[m] += s[m] / n;
    }
    for (const auto& s : all) {
      long double deviation = 0;
      for (std::size_t m = 0; m < 3; ++m) deviation += kWeight[m] * (s[m] - mean[m]);
      variance_of_mean += deviation * deviation / (n * (n - 1));
    }
  }
};

void check_against_two_passes(const Comoments& found, const Samples& all, double tolerance) {
  const TwoPass known(all);
  CHECK(found.count() == static_cast<double>(all.size()));
  for (std::size_t m = 0; m < 3; ++m) {
    CHECK(found.mean(m) == Approx(static_cast<double>(known.mean[m])).epsilon(1e-14));
  }
  CHECK(found.variance_of_mean(kWeight) ==
        Approx(static_cast<double>(known.variance_of_mean)).epsilon(tolerance));
}

}  // namespace

TEST_CASE("comoments: means and variances as by two passes") {
  const auto all = samples(1000, 0);
  check_against_two_passes(of(all, 0, 1000), all, 1e-12);
}

// Sums of squares would have lost all digits: 1e9^2 against a variance of 1.
TEST_CASE("comoments: huge offsets do not cancel") {
  const auto all = samples(1000, 1e9);
  auto merged = of(all, 0, 400);
  merged.merge(of(all, 400, 1000).numbers());
  check_against_two_passes(of(all, 0, 1000), all, 1e-6);
  check_against_two_passes(merged, all, 1e-6);
}

TEST_CASE("comoments: merging parts is adding their samples") {
  const auto all = samples(1000, 2);
  for (std::size_t split : {0UL, 1UL, 2UL, 500UL, 999UL, 1000UL}) {
    INFO("split at " << split);
    auto merged = of(all, 0, split);
    merged.merge(of(all, split, 1000).numbers());
    check_against_two_passes(merged, all, 1e-12);
  }
}

TEST_CASE("comoments: merging into nothing and nothing keeps the bits") {
  const auto all = samples(10, 1);
  const auto part = of(all, 0, 10);
  Comoments empty(3), same = part;
  empty.merge(part.numbers());
  same.merge(Comoments(3).numbers());
  for (const auto* c : {&empty, &same}) {
    CHECK(c->count() == 10);
    for (std::size_t m = 0; m < 3; ++m) CHECK(c->mean(m) == part.mean(m));
    CHECK(c->variance_of_mean(kWeight) == part.variance_of_mean(kWeight));
  }
}

TEST_CASE("comoments: nothing merged into nothing is nothing, and takes samples") {
  const auto all = samples(10, 1);
  Comoments nothing(3);
  nothing.merge(Comoments(3).numbers());
  CHECK(nothing.count() == 0);
  for (const auto& s : all) nothing.add(s);
  check_against_two_passes(nothing, all, 1e-12);
}

// In exact arithmetic the combination is 0; its variance must not round to less.
TEST_CASE("comoments: a sample that counts several times is that many samples") {
  const auto all = samples(10, 2);
  auto once = of(all, 0, 5), repeated = once;
  for (int n = 0; n < 7; ++n) repeated.add(all[5]);
  once.add(all[5], 7);
  CHECK(once.count() == repeated.count());
  for (std::size_t n = 0; n < 3; ++n)
    CHECK(once.mean(n) == Approx(repeated.mean(n)).epsilon(1e-14));
  CHECK(once.variance_of_mean(kWeight) ==
        Approx(repeated.variance_of_mean(kWeight)).epsilon(1e-12));
}

TEST_CASE("comoments: no variance is negative") {
  for (int n = 1; n <= 300; ++n) {
    const double factor = 0.1 * n;
    Comoments c(2);
    for (double a : {0.3, 0.7, 1.1, 1.9}) c.add(std::vector{a, factor * a});
    const double variance = c.variance_of_mean(std::vector{factor, -1.0});
    CHECK(variance >= 0);
    CHECK(variance <= 1e-14 * factor * factor);
  }
}

TEST_CASE("comoments: one sample shows nothing of the spread, equal ones show there is none") {
  const auto one = samples(1, 0);
  CHECK(std::isinf(Comoments(3).variance_of_mean(kWeight)));
  CHECK(std::isinf(of(one, 0, 1).variance_of_mean(kWeight)));
  CHECK(of({one[0], one[0]}, 0, 2).variance_of_mean(kWeight) == 0);
}

TEST_CASE("comoments: with the numbers of others they continue alike") {
  const auto all = samples(100, 3);
  const auto first = of(all, 0, 60);
  const auto row = first.numbers();
  Comoments back(3);
  REQUIRE(back.numbers().size() == row.size());
  std::copy(row.begin(), row.end(), back.numbers().begin());
  auto continued = first;
  for (std::size_t n = 60; n < 100; ++n) {
    continued.add(all[n]);
    back.add(all[n]);
  }
  const auto a = continued.numbers(), b = back.numbers();
  CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end()));
}
