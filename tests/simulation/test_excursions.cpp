#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "../common/catch.hpp"
#include "../common/tallies.hpp"
#include "stickslip/simulation/flow.hpp"
#include "stickslip/simulation/tally.hpp"
#include "stickslip/simulation/walk.hpp"

using namespace stickslip;
using simulation::Excursion;
using simulation::RandomStream;
using simulation::Wanted;

namespace {

const Wanted kAll{.integrals = true, .noise = true, .omega = {0, 0.7, 5}};

// With 2/(tau delta^2) a whole number, so that the noise is the urn and its distribution binomial.
model::Process process(double mu_s, double mu_d, double tau, double delta, model::Drag drag) {
  return {{tau, delta, model::full_range(tau, delta)}, {mu_s, mu_d}, drag};
}

struct Case {
  const char* name;
  model::Process process;
};

std::vector<Case> processes() {
  return {{"linear drag", process(1, 0.25, 1, 0.5, {1, 0})},
          {"no drag", process(1, 1, 1, 0.5, {0, 0})},
          {"off the grid", process(1.1, 1.1, 1, 0.5, {1, 0})},
          {"k = 0", process(0.2, 0.15, 1, 0.5, {1, 0})},
          {"strong drag, slow noise", process(1, 0.6, 2, 0.5, {3, 0})}};
}

std::vector<Excursion> draw(const model::Process& p, const Wanted& wanted, int count,
                            std::uint64_t seed = 1, std::size_t side = 0) {
  const auto source = simulation::make_source(p, wanted);
  RandomStream random(seed, 0), places(seed, 1);
  std::vector<Excursion> all(static_cast<std::size_t>(count));
  for (auto& e : all) source->draw(random, p.exit_level(side == 0), places.uniform(), e);
  return all;
}

/// Mean of f over independent excursions in units of its standard error.
template <class F>
double deviation_of_mean(const std::vector<Excursion>& all, F f) {
  double sum = 0, squares = 0;
  for (const auto& e : all) {
    const double value = f(e);
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(all.size());
  return sum / std::sqrt(squares - sum * sum / n);
}

/// P(X = x_i) of the urn of 2N balls.
double binomial(int levels, int i) {
  return std::exp(std::lgamma(2 * levels + 1) - std::lgamma(levels + i + 1) -
                  std::lgamma(levels - i + 1) - 2 * levels * std::log(2));
}

/// Mean time from each level |i| <= k until |X| > x_k, by sums over the scale of the chain.
std::vector<double> mean_sticking_times(const model::NoiseChain& noise, int k) {
  // d_i = h_i - h_{i+1}: alpha_i d_i = (1 - alpha_i) d_{i-1} + 1/Lambda, d_{-i-1} = -d_i.
  std::vector<double> sticking(2 * static_cast<std::size_t>(k) + 1);
  double d = 1 / noise.rate() / (noise.up(0) + noise.down(0)), sum = 0;
  std::vector<double> steps{d};
  for (int i = 1; i <= k; ++i) {
    d = (noise.down(i) * d + 1 / noise.rate()) / noise.up(i);
    steps.push_back(d);
  }
  for (int i = k; i >= 0; --i) {
    sum += steps[static_cast<std::size_t>(i)];
    sticking[static_cast<std::size_t>(k + i)] = sticking[static_cast<std::size_t>(k - i)] = sum;
  }
  return sticking;
}

/// Probability of leaving |i| <= k downwards.
std::vector<double> turns(const model::NoiseChain& noise, int k) {
  // The scale s_{i+1} - s_i = prod (1 - alpha)/alpha, from level -k - 1 to k + 1.
  std::vector<double> scale{0, 1};
  double step = 1;
  for (int i = -k; i <= k; ++i) {
    step *= noise.down(i) / noise.up(i);
    scale.push_back(scale.back() + step);
  }
  std::vector<double> turn;
  for (int i = -k; i <= k; ++i) {
    turn.push_back(1 - scale[static_cast<std::size_t>(i + k + 1)] / scale.back());
  }
  return turn;
}

/// Durations, displacements and turns of the excursions of a path, by the side of their beginning.
std::array<std::vector<Excursion>, 2> excursions_along(const model::Process& p, double horizon) {
  const auto path = simulation::simulate_path(p, {p.highest_static() + 1}, horizon, 3);
  std::array<std::vector<Excursion>, 2> all;
  double start = 1;
  Excursion e;
  for (std::size_t n = 0; n + 1 < path.time.size(); ++n) {
    if (n > 0 && path.y[n] != 0 && path.y[n - 1] == 0) {
      e.turned = path.y[n] != start;
      all[start > 0 ? 0 : 1].push_back(e);
      start = path.y[n];
      e = {};
    }
    const double time = path.time[n + 1] - path.time[n];
    (path.y[n] == 0 ? e.stick : e.slide) += time;
    if (path.y[n] == 0) continue;
    const auto half = path.y[n] > 0 ? p : p.mirrored();
    const double force =
        half.net_force(static_cast<int>(std::lround(path.y[n] * path.x[n] / p.noise.delta)));
    const auto piece =
        simulation::GeneralFlow(half.drag).move(std::abs(path.v[n]), force, time, true);
    e.drift += path.y[n] * piece.path;
  }
  return all;
}

/// Difference of two means in units of its standard deviation.
template <class F>
double difference_of_means(const std::vector<Excursion>& a, const std::vector<Excursion>& b, F f) {
  double mean = 0, variance = 0;
  for (const auto* all : {&a, &b}) {
    const auto n = static_cast<double>(all->size());
    double sum = 0, squares = 0;
    for (const auto& e : *all) sum += f(e), squares += f(e) * f(e);
    mean += (all == &a ? 1 : -1) * sum / n;
    variance += (squares - sum * sum / n) / (n * (n - 1));
  }
  return mean / std::sqrt(variance);
}

}  // namespace

TEST_CASE("excursions: every one begins and ends at rest, with what that means") {
  for (const auto& c : processes()) {
    INFO(c.name);
    const int k = c.process.highest_static();
    for (const auto& e : draw(c.process, kAll, 2000)) {
      REQUIRE(e.slide > 0);
      REQUIRE(e.stick > 0);
      REQUIRE(std::abs(e.entry) <= k);
      REQUIRE(e.jumps >= 1);
      REQUIRE(e.square > 0);
      REQUIRE(e.within >= e.stick);
      REQUIRE(e.within <= (e.slide + e.stick) * (1 + 1e-14));
      // v^2/2 is back at 0: power put in by the noise, less that of friction and drag.
      const double lost = c.process.friction.mu_d * e.path + c.process.drag.linear * e.square;
      REQUIRE(e.product == Approx(lost).epsilon(1e-9).margin(1e-15));
      REQUIRE(e.transform.size() == 3);
      REQUIRE(std::abs(e.transform[0]) <= e.path * (1 + 1e-12));
      REQUIRE(std::abs(e.transform[0].imag()) <= 1e-12 * e.path);
      REQUIRE(std::abs(e.transform[2]) <= std::abs(e.path) * (1 + 1e-12));
    }
  }
}

// Only at the edge of the static levels, mu_d = mu_s, do bodies turn round at once.
TEST_CASE("excursions: transform at omega = 0 is the path unless the body was turned round") {
  int forth = 0, back = 0;
  for (const auto& e : draw(process(0.2, 0.2, 1, 0.5, {1, 0}), kAll, 2000)) {
    if (std::abs(e.transform[0].real() - e.path) <= 1e-12 * e.path) {
      ++forth;
    } else {
      ++back;
    }
  }
  CHECK(forth > 500);
  CHECK(back > 100);
}

TEST_CASE("excursions: durations are the same whatever is followed, and repeat") {
  for (const auto& c : processes()) {
    const auto bare = draw(c.process, {}, 500), full = draw(c.process, kAll, 500),
               other = draw(c.process, {}, 500, 2);
    for (std::size_t n = 0; n < bare.size(); ++n) {
      REQUIRE(bare[n].slide == full[n].slide);
      REQUIRE(bare[n].stick == full[n].stick);
      REQUIRE(bare[n].entry == full[n].entry);
      REQUIRE(bare[n].turned == full[n].turned);
      REQUIRE(bare[n].slide != other[n].slide);
    }
  }
}

// A cubic term too small to count sends the same case through the integrator.
TEST_CASE("excursions: the integrator follows the closed forms jump by jump") {
  for (auto c : processes()) {
    INFO(c.name);
    const auto exact = draw(c.process, kAll, 300);
    c.process.drag.cubic = 1e-300;
    const auto integrated = draw(c.process, kAll, 300);
    for (std::size_t n = 0; n < exact.size(); ++n) {
      const auto &a = exact[n], &b = integrated[n];
      REQUIRE(b.jumps == a.jumps);
      REQUIRE(b.entry == a.entry);
      REQUIRE(b.slide == Approx(a.slide).epsilon(1e-9));
      REQUIRE(b.stick == Approx(a.stick).epsilon(1e-9));
      REQUIRE(b.square == Approx(a.square).epsilon(1e-9));
      REQUIRE(b.product == Approx(a.product).epsilon(1e-9));
      for (std::size_t w = 0; w < 3; ++w) {
        REQUIRE(std::abs(b.transform[w] - a.transform[w]) < 1e-9 * (1 + a.path));
      }
    }
  }
}

TEST_CASE("excursions: the noise on the way has the binomial distribution within 4 sigma") {
  for (const auto& c : processes()) {
    INFO(c.name);
    const int levels = c.process.noise.levels, k = c.process.highest_static();
    double within = 0;
    for (int i = -k; i <= k; ++i) within += binomial(levels, i);
    const double variance = 1 / c.process.noise.tau;
    const auto all = draw(c.process, {false, true, {}, {}, {}}, 100000);
    const auto off_within = [&](const Excursion& e) {
      return e.within - within * (e.slide + e.stick);
    };
    const auto off_variance = [&](const Excursion& e) {
      return e.noise_square - variance * (e.slide + e.stick);
    };
    const auto off_jumps = [&](const Excursion& e) {
      return e.jumps - c.process.noise.rate() * (e.slide + e.stick);
    };
    CHECK(std::abs(deviation_of_mean(all, off_within)) < 4);
    CHECK(std::abs(deviation_of_mean(all, off_variance)) < 4);
    CHECK(std::abs(deviation_of_mean(all, off_jumps)) < 4);
  }
}

TEST_CASE(
    "excursions: sticking times and turns follow from the entry by closed sums, within 4 sigma") {
  for (const auto& c : processes()) {
    INFO(c.name);
    const int k = c.process.highest_static();
    const auto sticking = mean_sticking_times(c.process.noise, k), turn = turns(c.process.noise, k);
    const auto all = draw(c.process, {}, 100000);
    for (int i = -k; i <= k; ++i) {
      const auto at = static_cast<std::size_t>(i + k);
      const auto from_here = [i](const Excursion& e) { return e.entry == i ? 1.0 : 0.0; };
      const auto count =
          std::accumulate(all.begin(), all.end(), 0.0,
                          [&](double sum, const Excursion& e) { return sum + from_here(e); });
      if (count < 100) continue;
      INFO("from level " << i);
      CHECK(std::abs(deviation_of_mean(all, [&](const Excursion& e) {
              return from_here(e) * (e.stick - sticking[at]);
            })) < 4);
      CHECK(std::abs(deviation_of_mean(all, [&](const Excursion& e) {
              return from_here(e) * (e.turned - turn[at]);
            })) < 4);
    }
  }
}

namespace {

std::vector<Case> cases_without_symmetry() {
  auto up = process(1, 0.25, 1, 0.5, {1, 0}), down = up, law = up, turned = up;
  up.bias = 0.3;
  down.bias = -0.6;
  law.drag = {0, 0, [](double v) { return v > 0 ? -v : -3 * v; }, 1e6, false};
  turned = process(0.5, 0.5, 1, 0.5, {1, 0});
  turned.bias = -0.1;
  auto hard = up;  // rests on positive levels alone
  hard.bias = -1.6;
  return {{"pushed up", up},
          {"pushed down", down},
          {"pushed hard", hard},
          {"drag law", law},
          {"turned round", turned}};
}

}  // namespace

// v^2/2 is back at 0: power of the noise and of the bias, less that of friction and drag.
TEST_CASE("excursions: energy is conserved without symmetry, from both sides") {
  for (const auto& c : cases_without_symmetry()) {
    if (!c.process.drag.is_linear()) continue;
    INFO(c.name);
    for (std::size_t side : {0, 1}) {
      for (const auto& e : draw(c.process, kAll, 1000, 1, side)) {
        const double lost = c.process.friction.mu_d * e.path + c.process.drag.linear * e.square;
        REQUIRE(e.product + c.process.bias * e.drift ==
                Approx(lost).epsilon(1e-9).margin(1e-14 + 1e-9 * e.path));
        REQUIRE(std::abs(e.transform[0] - e.drift) <= 1e-11 * e.path);
        REQUIRE(std::abs(e.drift) <= e.path * (1 + 1e-12));
      }
    }
  }
}

TEST_CASE("excursions: without symmetry they are those along a path, within 4 sigma") {
  const Wanted wanted{.integrals = true};
  for (const auto& c : cases_without_symmetry()) {
    const auto along = excursions_along(c.process, 20000);
    for (std::size_t side : {0, 1}) {
      INFO(c.name << " from side " << side);
      const auto drawn = draw(c.process, wanted, 10000, 1, side);
      const auto apart = [&](const auto& f) {
        return std::abs(difference_of_means(along[side], drawn, f));
      };
      REQUIRE(along[side].size() > 50);
      CHECK(apart([](const auto& e) { return e.slide; }) < 4);
      CHECK(apart([](const auto& e) { return e.stick; }) < 4);
      CHECK(apart([](const auto& e) { return e.drift; }) < 4);
      CHECK(apart([](const auto& e) { return e.turned ? 1.0 : 0.0; }) < 4);
    }
  }
}

// The bias mirrored, with the same numbers.
TEST_CASE("excursions: from s- they are those of the mirrored process from s+") {
  auto p = process(1, 0.25, 1, 0.5, {1, 0.3});
  p.bias = 0.3;
  p.friction.mu_d_minus = 0.5;
  auto wanted = kAll;
  wanted.observables = {model::parse_observable("v^3 + x*y", p.friction)};
  wanted.discount = {0.5};
  auto mirrored = wanted;
  mirrored.observables = {model::parse_observable("-v^3 + x*y", p.friction)};
  const auto here = draw(p, wanted, 20000, 1, 1), there = draw(p.mirrored(), mirrored, 20000, 2, 0);
  const auto apart = [&](const auto& f) { return std::abs(difference_of_means(here, there, f)); };
  CHECK(apart([](const auto& e) { return e.slide; }) < 4);
  CHECK(apart([](const auto& e) { return e.turned ? 1.0 : 0.0; }) < 4);
  CHECK(apart([](const auto& e) { return e.integrals[0].slide; }) < 4);
  CHECK(apart([](const auto& e) { return e.discounted[0].value; }) < 4);
  const auto drift = [](const auto& all) {
    return std::accumulate(all.begin(), all.end(), 0.0,
                           [](double sum, const auto& e) { return sum + e.drift; });
  };
  CHECK(drift(here) * drift(there) < 0);
}

// v^2, x v and 1, whose integrals are followed exactly as well; steps and jumps in time.
TEST_CASE("excursions: integrals of observables are right in the mean, within 4 sigma") {
  auto biased = process(1, 0.25, 1, 0.5, {1, 0.3});
  biased.bias = 0.3;
  for (const auto& p : {process(1, 0.25, 1, 0.5, {1, 0}), biased}) {
    Wanted wanted = kAll;
    for (const char* f : {"1", "v^2", "x*v", "abs(x) <= 1 ? 1 : 0", "stick", "v"}) {
      wanted.observables.push_back(model::parse_observable(f, p.friction));
    }
    wanted.discount = {0, 0.5};
    const auto all = draw(p, wanted, 20000);
    for (const auto& e : all) {
      REQUIRE(e.integrals[0].slide == Approx(e.slide).epsilon(1e-12));
      REQUIRE(e.integrals[0].stick == Approx(e.stick).epsilon(1e-12));
      REQUIRE(e.integrals[4].stick == Approx(e.stick).epsilon(1e-12));
      REQUIRE(e.integrals[4].slide == 0);
      REQUIRE(e.discounted[0].value == Approx(e.slide + e.stick).epsilon(1e-12));
      REQUIRE(e.discounted[2].mirrored == Approx(e.discounted[2].value).epsilon(1e-12));
      const double within = e.integrals[3].slide + e.integrals[3].stick;
      REQUIRE(within == Approx(e.within).epsilon(1e-12).margin(1e-12));
    }
    const auto off = [&](const auto& f) { return std::abs(deviation_of_mean(all, f)); };
    CHECK(off([](const auto& e) { return e.integrals[1].slide - e.square; }) < 4);
    CHECK(off([](const auto& e) { return e.integrals[2].slide - e.product; }) < 4);
    CHECK(off([](const auto& e) { return e.discounted[5].value - e.drift; }) < 4);
    const auto one = [](const Excursion& e) {
      return (1 - std::exp(-0.5 * (e.slide + e.stick))) * 2;
    };
    CHECK(off([&](const auto& e) { return e.discounted[6].value - one(e); }) < 4);
  }
}

TEST_CASE(
    "excursions: the noise keeps its distribution in the mean over both sides, within 4 sigma") {
  for (const auto& c : cases_without_symmetry()) {
    INFO(c.name);
    const int levels = c.process.noise.levels,
              k = c.process.noise.last_up_to(c.process.friction.mu_s);
    double within = 0;
    for (int i = -k; i <= k; ++i) within += binomial(levels, i);
    simulation::Sampler sampler({.quantities = {cases::Quantity::noise_law}}, c.process);
    const auto& tally = sampler.batch(1, 0, 10000);
    const auto holds = [](const simulation::Estimate& e, double value) {
      return std::abs(e.value - value) < 4 * (e.high - e.value) / 1.96;
    };
    CHECK(holds(test::estimate(tally, "P_X_le_mu_s"), within));
    CHECK(holds(test::estimate(tally, "E_X2"), 1 / c.process.noise.tau));
  }
}
