#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/quadrature.hpp"
#include "stickslip/generator/static_chain.hpp"
#include "stickslip/model/gaussian.hpp"
#include "stickslip/quantities/durations.hpp"

using namespace stickslip;
using quantities::DurationDistribution;
using quantities::stick_distribution;
using quantities::Uncertain;

namespace {

model::Process process_on(const model::LevelTable& table, double mu_s = 1) {
  return {{.table = std::make_shared<const model::LevelTable>(table)}, {mu_s, 0.5}, {1, 0}};
}

model::Process ornstein_uhlenbeck(double delta, int levels, double mu_s) {
  return {{1, delta, levels}, {mu_s, 0.25}, {1, 0}};
}

// The same chain with a jump that never happens, so that it is one of any jumps.
model::Process of_any_jumps(const model::Process& process) {
  const auto& noise = process.noise;
  std::vector<double> x;
  std::vector<model::Transition> jumps{{0, 2, 1e-40}};
  for (int i = noise.lowest(); i <= noise.highest(); ++i) {
    const auto from = x.size();
    x.push_back(noise.level(i));
    noise.for_each_jump(i, [&](int to, double rate) {
      jumps.push_back({from, static_cast<std::size_t>(to - noise.lowest()), rate});
    });
  }
  model::Process other = process;
  other.noise = {.table = std::make_shared<const model::LevelTable>(x, jumps)};
  return other;
}

model::Process gaussian(const std::vector<model::CovarianceTerm>& terms, int order) {
  const model::GaussianNoise noise(terms);
  return {{.table = noise.projected({{-1, 1}, {-0.5, 0.5}}, order)}, {1, 0.5}, {1, 0}};
}

std::vector<Uncertain> all_on(const model::Process& process, int level) {
  const int lowest = process.lowest_static(), count = process.highest_static() - lowest + 1;
  std::vector<Uncertain> entry(static_cast<std::size_t>(count));
  entry[static_cast<std::size_t>(level - lowest)] = {1, 0};
  return entry;
}

void check(Uncertain found, double known) {
  INFO("off by " << found.value / known - 1 << ", stated " << found.error / known);
  CHECK(std::abs(found.value - known) <= found.error);
  CHECK(found.error <= 2e-11 * known);
}

using Function = std::function<double(double)>;

void check(const DurationDistribution& found, const std::vector<double>& time,
           const Function& density, const Function& distribution) {
  for (std::size_t n = 0; n < time.size(); ++n) {
    INFO("time " << time[n]);
    check(found.density[n], density(time[n]));
    check(found.distribution[n], distribution(time[n]));
  }
}

}  // namespace

TEST_CASE("stick distribution: one level is left by an exponential time") {
  const auto process = process_on(model::LevelTable({{-2, 1, 0}, {0, 1.5, 1}, {2, 0, 1}}));
  const std::vector<double> time{1e-12, 1e-3, 0.4, 3, 40, 200};
  check(
      stick_distribution(process, {{1, 0}}, time), time,
      [](double t) { return 2.5 * std::exp(-2.5 * t); },
      [](double t) { return -std::expm1(-2.5 * t); });
}

// Q = ((-3, 1), (2, -6)) and exits 2 and 4 from the first level.
TEST_CASE("stick distribution: two levels are left by two exponential times") {
  const auto process =
      process_on(model::LevelTable({{-2, 1, 0}, {-0.5, 1, 2}, {0.5, 4, 2}, {2, 0, 1}}));
  const double root = std::sqrt(17.0), slow = (9 - root) / 2, fast = (9 + root) / 2;
  // f(0) = 2 and f'(0) = -3 f(0) + 4.
  const double of_slow = (2 * fast - 2) / root, of_fast = 2 - of_slow;
  const std::vector<double> time{1e-6, 0.02, 0.6, 5, 60, 150};
  check(
      stick_distribution(process, all_on(process, process.lowest_static()), time), time,
      [&](double t) { return of_slow * std::exp(-slow * t) + of_fast * std::exp(-fast * t); },
      [&](double t) {
        return -of_slow / slow * std::expm1(-slow * t) - of_fast / fast * std::expm1(-fast * t);
      });
}

// By jumps alone, and by squares where long times are asked for, too.
TEST_CASE("stick distribution: five stages take a time of Erlang's distribution") {
  const std::vector<double> x{0, 0.1, 0.2, 0.3, 0.4, 2};
  const auto process =
      process_on({x, {{0, 1, 3}, {1, 2, 3}, {2, 3, 3}, {3, 4, 3}, {4, 5, 3}, {5, 0, 1}}});
  const auto density = [](double t) { return 3 * std::pow(3 * t, 4) / 24 * std::exp(-3 * t); };
  const auto distribution = [](double t) {
    double term = std::exp(-3 * t) * std::pow(3 * t, 5) / 120, sum = 0;
    for (int n = 6; n < 1000; ++n) {
      sum += term;
      term *= 3 * t / n;
    }
    return sum;
  };
  for (double last : {4.0, 200.0}) {
    const std::vector<double> time{1e-3, 0.01, 0.5, last};
    check(stick_distribution(process, all_on(process, process.lowest_static()), time), time,
          density, distribution);
  }
}

// The rate of leaving is that of the slowest mode, 1.6e-9 of that of the noise.
TEST_CASE("stick distribution: long rests end at one rate, which keeps its digits") {
  const auto chain = ornstein_uhlenbeck(0.25, 32, 6);
  const double mean = generator::StaticChain::of(chain).integral(
      std::vector<double>(2 * static_cast<std::size_t>(chain.highest_static()) + 1,
                          1.0))[static_cast<std::size_t>(chain.highest_static())];
  const std::vector<double> time{1e3, mean, 3 * mean, 300 * mean};
  for (const auto& process : {chain, of_any_jumps(chain)}) {
    const int middle = (process.lowest_static() + process.highest_static()) / 2;
    const auto found = stick_distribution(process, all_on(process, middle), time);
    const auto& f = found.density;
    const double rate = f[1].value / (1 - found.distribution[1].value);
    CHECK(test::relative_difference(rate * mean, 1) < 1e-7);  // and the start takes its time
    for (std::size_t n : {0, 2, 3}) {
      const double fall = std::exp(-rate * (time[n] - mean));
      INFO("time " << time[n]);
      CHECK(test::relative_difference(f[n].value, fall * f[1].value) < 1e-10);
      CHECK(f[n].error < 1e-10 * f[n].value);
    }
    CHECK(test::relative_difference(found.distribution[0].value, rate * 1e3) < 0.1);
  }
}

TEST_CASE("stick distribution: resolvents and squares agree on a chain of many levels") {
  const auto chain = ornstein_uhlenbeck(1.0 / 32, 96, 1), other = of_any_jumps(chain);
  const std::vector<double> time{1e-4, 0.003, 0.02, 0.3, 2, 30};
  for (int from : {0, 20, 31}) {
    const auto one = stick_distribution(chain, all_on(chain, from), time),
               two = stick_distribution(other, all_on(other, other.lowest_static() + 32 + from),
                                        time);
    for (std::size_t n = 0; n < time.size(); ++n) {
      for (auto part : {&DurationDistribution::density, &DurationDistribution::distribution}) {
        const Uncertain a = (one.*part)[n], b = (two.*part)[n];
        INFO("from " << from << " at " << time[n] << ": " << a.value << ", " << b.value);
        CHECK(std::abs(a.value - b.value) <= a.error + b.error);
        CHECK(a.error <= 1e-10 * a.value + 1e-24);
      }
    }
  }
}

// u = 1 - x^2 has u'' - x u' = -2 u: the slowest mode on |x| < 1, of the rate 2 exactly.
TEST_CASE("stick distribution: Ornstein-Uhlenbeck noise itself leaves |X| < 1 at the rate 2") {
  const auto process = gaussian({{1, 1}}, 8);
  const std::vector<double> time{4, 8, 40};
  const auto found = stick_distribution(process, all_on(process, 0), time);
  const auto& f = found.density;
  for (std::size_t n = 0; n < time.size(); ++n) {
    const double fall = std::exp(-2 * (time[n] - time[0]));
    INFO("time " << time[n]);
    CHECK(std::abs(f[n].value - fall * f[0].value) <= f[n].error + fall * f[0].error);
    CHECK(f[n].error < 1e-4 * f[n].value);
  }
  CHECK(test::relative_difference(f[0].value, 2 * (1 - found.distribution[0].value)) < 1e-6);
}

TEST_CASE("stick distribution: nodes of Gaussian noise have the transforms of their resolvents") {
  using Terms = std::vector<model::CovarianceTerm>;
  for (const auto& terms : {Terms{{1, 1}}, Terms{{1, 0.5, 2}}, Terms{{0.6, 1}, {0.4, 5}}}) {
    const auto process = gaussian(terms, 5);
    std::vector<Uncertain> entry;
    double total = 0;
    const auto weights = model::stationary_distribution(process.noise);
    for (int i = process.lowest_static(); i <= process.highest_static(); ++i) {
      entry.push_back({weights[static_cast<std::size_t>(i - process.noise.lowest())], 0});
      total += entry.back().value;
    }
    const auto q = test::logarithmic_panels(1e-12, 1e3, 24);
    const auto found = stick_distribution(process, entry, q.node);
    for (double lambda : {0.1, 1.0, 20.0}) {
      const double sum = q.sum([&](std::size_t n) {
        return lambda * std::exp(-lambda * q.node[n]) * found.distribution[n].value;
      });
      INFO(terms.size() << " terms, lambda " << lambda);
      CHECK(std::abs(sum - quantities::stick_transform(process, lambda, entry).value) <
            1e-8 * total);
    }
  }
}
