#include "stickslip/model/process.hpp"

#include <fmt/format.h>

#include "stickslip/base/text.hpp"
#include "stickslip/linalg/dense.hpp"

namespace stickslip::model {
namespace {

// The share of excursions below which a start does not count.
constexpr double kNegligibleShare = 1e-18;

// The first and the last level with the force of level i.
struct Block {
  Block(const NoiseChain& chain, int i) : first(i), last(i) {
    while (first > chain.lowest() && chain.level(first - 1) == chain.level(i)) --first;
    while (last < chain.highest() && chain.level(last + 1) == chain.level(i)) ++last;
  }
  [[nodiscard]] bool holds(int i) const { return first <= i && i <= last; }

  int first, last;
};

}  // namespace

// What leaves the highest level that sticks upwards against what leaves the lowest one downwards,
// by the stationary distribution of the noise: in logarithms, which neither overflow nor vanish.
bool Process::starts_upwards() const {
  const int high = highest_static(), low = lowest_static();
  if (high >= noise.highest()) return false;
  if (low <= noise.lowest() || !sticks()) return true;
  if (!noise.neighbours_only()) return most_frequent_start(true) > high;
  double log_ratio = std::log(noise.up_rate(high) / noise.down_rate(low));
  for (int i = low + 1; i <= high; ++i) log_ratio += std::log(weight_ratio(noise, i));
  return log_ratio > std::log(kNegligibleShare);
}

std::vector<int> Process::starts() const {
  std::vector<int> all;
  if (!noise.neighbours_only()) {
    for (const auto& [level, flow] : flows_to_starts()) all.push_back(level);
  } else if (sticks()) {
    if (starts_downwards()) all.push_back(lowest_static() - 1);
    if (starts_upwards()) all.push_back(highest_static() + 1);
  }
  return all;
}

std::map<int, double> Process::flows_to_starts() const {
  const int high = highest_static(), low = lowest_static();
  const auto p = stationary_distribution(noise);
  std::map<int, double> flows;
  double total = 0;
  for (int i = low; i <= high; ++i) {
    noise.for_each_jump(i, [&](int to, double rate) {
      if (low <= to && to <= high) return;
      flows[to] += p[i - noise.lowest()] * rate;
      total += p[i - noise.lowest()] * rate;
    });
  }
  std::erase_if(flows,
                [total](const auto& each) { return !(each.second > kNegligibleShare * total); });
  return flows;
}

std::vector<double> Process::exit_rates() const {
  const int high = highest_static(), low = lowest_static();
  std::vector<double> rates(static_cast<std::size_t>(std::max(high - low + 1, 0)), 0.0);
  for (int i = low; i <= high; ++i) {
    noise.for_each_jump(i, [&](int to, double rate) {
      if (to < low || to > high) rates[i - low] += rate;
    });
  }
  return rates;
}

int Process::most_frequent_start(bool up) const {
  const int high = highest_static();
  const auto all = flows_to_starts();
  const auto most = std::max_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    const bool wanted_a = (a.first > high) == up, wanted_b = (b.first > high) == up;
    return wanted_a != wanted_b ? wanted_b : a.second < b.second;
  });
  return all.empty() ? (up ? noise.highest() : noise.lowest()) : most->first;
}

std::string please_report(const Process& process) {
  std::string drag = fmt::format("drag {} and {}", process.drag.linear, process.drag.cubic);
  if (process.drag.law) drag = "the drag of -drag_expression";
  return fmt::format(
      "; this should not happen: please report it with the model parameters mu_s = {}, mu_d = "
      "{}, tau = {}, delta = {}, noise_levels = {}, {}, bias = {}",
      process.friction.mu_s, process.friction.mu_d, process.noise.tau, process.noise.delta,
      process.noise.levels, drag, process.bias);
}

ChangeRates change_rates(const NoiseChain& chain, int i) {
  if (!chain.has_levels()) return {kInfinity, kInfinity};
  const Block block(chain, i);
  ChangeRates rates{kInfinity, 0};
  for (int from = block.first; from <= block.last; ++from) {
    double sum = 0;
    chain.for_each_jump(from, [&](int to, double rate) { sum += block.holds(to) ? 0 : rate; });
    rates = {std::min(rates.least, sum), std::max(rates.most, sum)};
  }
  return rates;
}

Unchanged unchanged(const NoiseChain& chain, int i, double time) {
  const Block block(chain, i);
  const int count = block.last - block.first + 1;
  if (!chain.has_levels()) {
    return {block.first, std::vector<double>(static_cast<std::size_t>(count), 0.0)};
  }
  if (count == 1) return {i, {std::exp(-chain.rate(i) * time)}};
  linalg::Matrix<double> killed(count, count);
  for (int from = block.first; from <= block.last; ++from) {
    const int row = from - block.first;
    killed(row, row) = -chain.rate(from);
    chain.for_each_jump(from, [&](int to, double rate) {
      if (block.holds(to)) killed(row, to - block.first) += rate;
    });
  }
  const auto moved = linalg::exponential(std::move(killed), time);
  Unchanged found{block.first};
  for (int n = 0; n < count; ++n) found.probability.push_back(moved(i - block.first, n));
  return found;
}

std::optional<double> effective_mu_s(const Scene& scene, bool backwards) {
  if (scene.noise.table || scene.noise.name.empty()) return std::nullopt;
  const Process forwards = scene.meant(), process = backwards ? forwards.mirrored() : forwards;
  const bool slides_there = process.highest_static() < process.noise.highest();
  if (!process.sticks() || !slides_there) return std::nullopt;
  const double given = process.friction.mu_s,
               effective = process.noise.level(process.highest_static()) + process.bias;
  constexpr double rounding = 1e-9;    // of the sum, and of what people write
  constexpr double negligible = 1e-6;  // of the distance of levels
  const double least =
      std::max(rounding * (given + std::abs(process.bias)), negligible * scene.delta);
  return std::abs(effective - given) <= least ? std::nullopt : std::optional(effective);
}

double largest_force(const Scene& scene) {
  const auto process = scene.meant();
  const auto& noise = process.noise;
  const double highest = std::max(noise.level(noise.highest()), -noise.level(noise.lowest()));
  const auto &along = scene.friction, against = along.mirrored();
  const double seen =
      std::max(along.mu_s, against.mu_s) + noise.step() + 12 * noise.standard_deviation();
  const double drawn = std::min(highest, noise.table ? highest : seen);
  return std::max(drawn, scene.force ? std::abs(scene.force->force[scene.force->peak()]) : 0) +
         std::abs(scene.bias) - std::min(along.mu_d, against.mu_d);
}

std::vector<double> levels_at(const NoiseChain& noise, const Start& start) {
  const bool one = start.kind == Start::Kind::state;
  if (!start.p && !one) return stationary_distribution(noise);
  std::vector<double> shares(static_cast<std::size_t>(noise.count()));
  if (!start.p) {
    shares[static_cast<std::size_t>(start.level - noise.lowest())] = 1;
    return shares;
  }
  const auto x = one ? std::optional(start.x) : std::nullopt;
  const int side = start.v == 0 ? 0 : start.v > 0 ? 1 : -1;
  for (const auto& [node, share] : noise.table->value_at(x, *start.p, side)) {
    shares[static_cast<std::size_t>(node)] += share;
  }
  return shares;
}

}  // namespace stickslip::model
