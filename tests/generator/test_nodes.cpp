#include <cmath>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <vector>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "stickslip/generator/noise_nodes.hpp"

using namespace stickslip;
using generator::Grouping;
using generator::Nodes;

namespace {

model::Process process(double delta, int levels, double mu_d, double bias = 0, double tau = 1) {
  return {{tau, delta, levels}, {1, mu_d}, {1, 0}, bias};
}

std::vector<model::Process> processes() {
  return {process(1.0 / 32, 260, 0.25),       process(0.03, 250, 0.9, 0.21),
          process(1.0 / 32, 260, 1, 0, 0.25), process(1.0 / 16, 128, 0.6, -1.7),
          process(1.0 / 512, 4100, 0.25),     process(0.25, 32, 0.25)};
}

double up(const model::Process& p, int i) { return p.noise.rate() * p.noise.up(i); }
double down(const model::Process& p, int i) { return p.noise.rate() * p.noise.down(i); }

// T^T Q P f by its definition, f given on the nodes.
double projected_generator(const Nodes& nodes, const model::Process& p, int node,
                           const std::vector<double>& f) {
  const auto at_level = [&](int i) {
    const auto& g = nodes.group_at(i);
    const auto shares = g.row(g.value, i);
    double sum = 0;
    for (int l = 0; l < g.count; ++l) sum += shares[l] * f[g.begin + l + nodes.last()];
    return sum;
  };
  const int top = p.noise.levels;
  return nodes.projected(node, [&](int i) {
    double sum = 0;
    if (i < top) sum += up(p, i) * (at_level(i + 1) - at_level(i));
    if (i > -top) sum += down(p, i) * (at_level(i - 1) - at_level(i));
    return sum;
  });
}

double applied(const Nodes& nodes, int node, const std::vector<double>& f) {
  double sum = 0;
  for (const auto& [to, rate] : nodes.jumps(node)) {
    sum += rate * (f[to + nodes.last()] - f[node + nodes.last()]);
  }
  return sum;
}

std::vector<double> at_nodes(const Nodes& nodes, double (*f)(double)) {
  std::vector<double> values;
  for (int n = nodes.first(); n <= nodes.last(); ++n) values.push_back(f(nodes.x(n)));
  return values;
}

}  // namespace

TEST_CASE("noise nodes: every level is a node, with the rates of the chain") {
  const auto p = process(0.25, 20, 0.25, 0.1);
  const Nodes nodes(p);
  CHECK(nodes.all_levels());
  CHECK(nodes.last() == 20);
  for (int i = -20; i <= 20; ++i) {
    CHECK(nodes.x(i) == p.noise.level(i));
    std::map<int, double> rates;
    for (const auto& [to, rate] : nodes.jumps(i)) rates[to] = rate;
    CHECK(rates.size() == (std::abs(i) == 20 ? 1 : 2));
    if (i < 20) CHECK(rates[i + 1] == up(p, i));
    if (i > -20) CHECK(rates[i - 1] == down(p, i));
  }
}

TEST_CASE("noise nodes: groups of few levels are their levels") {
  const auto p = process(0.25, 8, 0.25);
  const Nodes nodes(p, {9, 2});
  CHECK(nodes.all_levels());
}

TEST_CASE("noise nodes: groups follow one another, mirrored, and contain no special point") {
  for (const auto& p : processes()) {
    const Nodes nodes(p, {4, 2});
    const auto& groups = nodes.groups();
    int level = -p.noise.levels, node = nodes.first();
    for (std::size_t n = 0; n < groups.size(); ++n) {
      const auto& g = groups[n];
      const auto& mirror = groups[groups.size() - 1 - n];
      CHECK(g.first == level);
      CHECK(g.begin == node);
      CHECK(g.last == -mirror.first);
      CHECK(g.count == mirror.count);
      CHECK((g.count == g.levels() || g.count == 5));
      level = g.last + 1;
      node += g.count;
      for (double s : {p.friction.mu_d - p.bias, p.friction.mu_d + p.bias}) {
        for (double sign : {1.0, -1.0}) {
          const double at = sign * s / p.noise.delta;
          CHECK_FALSE((g.levels() > 1 && g.first - 0.5 < at && at < g.last + 0.5));
        }
      }
      for (int end :
           {p.highest_static(), p.lowest_static() - 1, p.noise.last_up_to(p.friction.mu_s)}) {
        CHECK_FALSE((g.first <= end && end < g.last));
      }
    }
    CHECK(level == p.noise.levels + 1);
    CHECK(node == nodes.last() + 1);
    for (int n = 0; n <= nodes.last(); ++n) CHECK(nodes.x(-n) == -nodes.x(n));
    for (int n = nodes.first(); n < nodes.last(); ++n) CHECK(nodes.x(n) < nodes.x(n + 1));
    const auto& exit = nodes.group_at(p.highest_static() + 1);
    CHECK(exit.count == 1);
    CHECK(nodes.last_up_to(p.highest_static()) + 1 == exit.begin);
  }
}

TEST_CASE("noise nodes: their number grows with the logarithm of 1/delta") {
  const Nodes coarse(process(1.0 / 64, 520, 0.25), {7, 2});
  const Nodes fine(process(1.0 / 1024, 8300, 0.25), {7, 2});
  CHECK(coarse.count() < 200);
  CHECK(fine.count() < 2 * coarse.count());
}

TEST_CASE("noise nodes: jumps are the chain's own, projected") {
  for (const auto& p : processes()) {
    const Nodes nodes(p, {4, 2});
    const auto f = at_nodes(nodes, [](double x) { return std::sin(3 * x) + std::exp(0.2 * x); });
    for (int n = nodes.first(); n <= nodes.last(); n += 3) {
      const double expected = projected_generator(nodes, p, n, f);
      double size = 0;
      for (const auto& jump : nodes.jumps(n)) size += std::abs(jump.value);
      CHECK(std::abs(applied(nodes, n, f) - expected) < 1e-9 * size);
    }
  }
}

// Q x = -x/tau, Q x^2 = Lambda delta^2 - 2 x^2/tau away from the ends, which weigh nothing here.
TEST_CASE("noise nodes: polynomials up to the degree have their exact images") {
  const auto p = process(1.0 / 64, 512, 0.25);
  const Nodes nodes(p, {5, 2});
  const auto x = at_nodes(nodes, [](double v) { return v; });
  const auto square = at_nodes(nodes, [](double v) { return v * v; });
  const double diffusion = p.noise.rate() * p.noise.delta * p.noise.delta;
  for (int n = nodes.first() + 12; n <= nodes.last() - 12; ++n) {
    const double at = nodes.x(n);
    double size = 0;
    for (const auto& [to, rate] : nodes.jumps(n)) {
      size += std::abs(rate * (nodes.x(to) - at)) * (1 + std::abs(at));
    }
    CHECK(std::abs(applied(nodes, n, x) + at) < 1e-11 * size);
    CHECK(std::abs(applied(nodes, n, square) - diffusion + 2 * at * at) < 1e-11 * size);
  }
}

TEST_CASE("noise nodes: the stationary distribution of the chain is theirs") {
  for (const auto& p : processes()) {
    const Nodes nodes(p, {4, 2});
    const auto distribution = model::stationary_distribution(p.noise);
    // gamma, the distribution on the nodes: P^T w.
    std::vector<double> gamma(static_cast<std::size_t>(nodes.count()), 0.0);
    for (const auto& g : nodes.groups()) {
      for (int i = g.first; i <= g.last; ++i) {
        const auto shares = g.row(g.value, i);
        for (int l = 0; l < g.count; ++l) {
          gamma[g.begin + l + nodes.last()] += distribution[i + p.noise.levels] * shares[l];
        }
      }
    }
    const auto spread = nodes.spread(gamma);
    for (std::size_t i = 0; i < distribution.size(); ++i) {
      CHECK(std::abs(spread[i] - distribution[i]) < 1e-11 * distribution[i] + 1e-250);
    }
    // gamma J = 0, flow by flow: detailed balance of the projection.
    std::map<std::pair<int, int>, double> flow;
    for (int n = nodes.first(); n <= nodes.last(); ++n) {
      for (const auto& [to, rate] : nodes.jumps(n)) flow[{n, to}] = gamma[n + nodes.last()] * rate;
    }
    for (const auto& [ends, there] : flow) {
      const double back = flow.at({ends.second, ends.first});
      const double most = gamma[ends.first + nodes.last()] * p.noise.rate();
      CHECK(std::abs(there - back) < 1e-9 * (std::abs(there) + 1e-3 * most) + 1e-250);
    }
  }
}

TEST_CASE("noise nodes: derivatives by tau are projected, too") {
  const double h = 1e-5;
  for (const auto& p : processes()) {
    const Nodes nodes(p, {4, 2});
    const auto f = at_nodes(nodes, [](double x) { return std::cos(x) + x; });
    auto above = p, below = p;
    above.noise.tau += h;
    below.noise.tau -= h;
    for (int n = nodes.first(); n <= nodes.last(); n += 5) {
      double found = 0, size = 0;
      for (const auto& [to, rate] : nodes.jumps_by_tau(n)) {
        found += rate * (f[to + nodes.last()] - f[n + nodes.last()]);
        size += std::abs(rate);
      }
      // On the nodes of p.
      const double expected =
          (projected_generator(nodes, above, n, f) - projected_generator(nodes, below, n, f)) /
          (2 * h);
      CHECK(std::abs(found - expected) < 1e-7 * size);
    }
  }
}

TEST_CASE("noise nodes: what cannot be a grouping") {
  const auto p = process(0.25, 20, 0.25);
  CHECK_THROWS_AS(Nodes(p, {-1, 2}), std::invalid_argument);
  CHECK_THROWS_AS(Nodes(p, {3, 0}), std::invalid_argument);
}

// What elements eliminate along: the jumps between groups, by the levels to which they lead.
TEST_CASE("noise nodes: of any chain every level is a node, and groups reach the next ones alone") {
  for (const auto& table :
       {test::five_states(), test::sine_and_levels(1.2, 4, 6, 0.5, 1, 0.7, 3)}) {
    const auto p = test::with_table(model::Scene{}, table).meant();
    const Nodes nodes(p);
    REQUIRE(nodes.all_levels());
    CHECK(nodes.last_up_to(1) == 1);
    const auto& groups = nodes.groups();
    double seen = 0, all = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto& here = groups[g];
      for (int l = 0; l < here.count; ++l) {
        p.noise.for_each_jump(here.begin + l, [&](int to, double rate) {
          all += rate;
          if (to >= here.begin && to < here.begin + here.count) seen += rate;
        });
      }
      const auto check = [&](const Nodes::Group& other, const std::vector<double>& rates,
                             std::span<const double> levels) {
        const auto rank = levels.size() / static_cast<std::size_t>(other.count);
        REQUIRE(rates.size() == rank * static_cast<std::size_t>(here.count));
        for (int l = 0; l < here.count; ++l) {
          std::map<int, double> jumps;
          p.noise.for_each_jump(here.begin + l, [&](int to, double rate) { jumps[to] = rate; });
          for (std::size_t r = 0; r < rank; ++r) {
            const double rate = rates[static_cast<std::size_t>(l) * rank + r];
            for (int k = 0; k < other.count; ++k) {
              if (levels[r * other.count + k] == 0 || rate == 0) continue;
              CHECK(jumps[other.begin + k] == rate);
              seen += rate;
            }
          }
        }
      };
      if (g > 0) check(groups[g - 1], here.to_below, groups[g - 1].at_last());
      if (g + 1 < groups.size()) check(groups[g + 1], here.to_above, groups[g + 1].at_first());
    }
    CHECK(std::abs(seen - all) < 1e-12 * all);
  }
  Grouping grouping;
  grouping.degree = 2;
  const auto p = test::with_table(model::Scene{}, test::five_states()).meant();
  CHECK_THROWS_AS(Nodes(p, grouping), std::invalid_argument);
}
