#include "stickslip/model/level_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "stickslip/support/infinity.hpp"
#include "transitions.hpp"

namespace stickslip::model {
namespace {

void require_rate(double rate, bool at_end, std::size_t row, const char* name) {
  if (at_end ? rate == 0 : rate > 0 && std::isfinite(rate)) return;
  throw UnfitTable(row, at_end ? fmt::format("{} = {:g} leads to no level; it must be 0 at the end "
                                             "of the levels",
                                             name, rate)
                               : fmt::format("{} = {:g} must be positive: every level must be "
                                             "reached from every other one",
                                             name, rate));
}

void require_chain(const std::vector<Level>& levels) {
  if (levels.size() < 2) throw UnfitTable(0, "there must be at least two levels");
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const auto& [x, up, down] = levels[n];
    if (!std::isfinite(x)) throw UnfitTable(n, fmt::format("x = {:g} must be a number", x));
    if (n > 0 && x <= levels[n - 1].x) {
      throw UnfitTable(
          n, fmt::format("x = {:g} must be above the level before, {:g}", x, levels[n - 1].x));
    }
    require_rate(up, n + 1 == levels.size(), n, "rate_up");
    require_rate(down, n == 0, n, "rate_down");
  }
}

int places_below_zero(const std::vector<Level>& levels) {
  const auto nearest = std::min_element(levels.begin(), levels.end(), [](auto& a, auto& b) {
    return std::abs(a.x) < std::abs(b.x) || (std::abs(a.x) == std::abs(b.x) && a.x > b.x);
  });
  return static_cast<int>(nearest - levels.begin());
}

// Probabilities up to a factor, the largest 1, from the logarithms of their ratios: neither
// overflows.
std::vector<double> weights(const std::vector<Level>& levels) {
  std::vector<double> w{0};
  for (std::size_t n = 1; n < levels.size(); ++n) {
    w.push_back(w.back() + std::log(levels[n - 1].up / levels[n].down));
  }
  const double largest = *std::max_element(w.begin(), w.end());
  for (double& value : w) value = std::exp(value - largest);
  return w;
}

}  // namespace

LevelTable::LevelTable(std::vector<Level> levels) : levels_(std::move(levels)) {
  require_chain(levels_);
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    const auto &here = levels_[n], &other = levels_[levels_.size() - 1 - n];
    even_ = even_ && here.x == -other.x && here.up == other.down;
  }
  find_moments();
  find_tails();
}

LevelTable::LevelTable(const std::vector<double>& given,
                       const std::vector<Transition>& transitions) {
  require_states(given, transitions);
  const auto x = without_rounding(given);
  const auto order = mirrored_order(x, transitions);
  order_ = order.states;
  std::vector<int> place(x.size());
  bool near = true;
  for (std::size_t n = 0; n < x.size(); ++n) {
    place[order_[n]] = static_cast<int>(n);
    levels_.push_back({x[order_[n]], 0, 0});
    near = near && (n == 0 || levels_[n - 1].x < levels_[n].x);
    even_ = even_ && levels_[n].x == -x[order_[x.size() - 1 - n]];
  }
  jumps_.resize(x.size());
  for (const auto& [from, to, rate] : transitions) {
    const int here = place[from], there = place[to];
    near = near && std::abs(there - here) == 1;
    jumps_[here].push_back({there, rate});
    (there > here ? levels_[here].up : levels_[here].down) += rate;
  }
  for (auto& row : jumps_) {
    std::sort(row.begin(), row.end(), [](const Jump& a, const Jump& b) { return a.to < b.to; });
  }
  even_ = even_ && mirrors_itself(jumps_, order.image);
  reversed_ = order.reversed();
  if (near) jumps_.clear();
  find_moments();
  find_tails();
}

void LevelTable::find_moments() {
  lowest_ = -places_below_zero(levels_);
  step_ = kInfinity;
  if (!neighbours_only()) probability_ = stationary(jumps_);
  const auto w = neighbours_only() ? weights(levels_) : probability_;
  mode_ = lowest_ + static_cast<int>(std::max_element(w.begin(), w.end()) - w.begin());
  double total = 0;
  for (std::size_t n = 0; n < w.size(); ++n) {
    total += w[n];
    mean_ += w[n] * levels_[n].x;
  }
  mean_ = even_ && !neighbours_only() ? 0 : mean_ / total;
  std::vector<double> part, f;
  for (std::size_t n = 0; n < w.size(); ++n) {
    f.push_back(levels_[n].x - mean_);
    part.push_back(w[n] * f[n] / total);
    rate_ = std::max(rate_, levels_[n].up + levels_[n].down);
    variance_ += part[n] * f[n];
    const double step = n > 0 ? levels_[n].x - levels_[n - 1].x : 0;
    if (step > 0) step_ = std::min(step_, step);
  }
  if (neighbours_only()) {
    add_edges(w, part, total);
  } else {
    intensity_ = model::intensity(jumps_, probability_, f);
    peak_intensity_ = model::peak_intensity(jumps_, probability_, f);
  }
  if (!std::isnormal(std::max(intensity_, peak_intensity_)) || !std::isnormal(variance_)) {
    throw UnfitTable(levels_.size(), "the rates lead to probabilities beyond double precision");
  }
}

// With S_i = sum_(j <= i) pi_j (x_j - m), the intensity is sum_i S_i^2/(pi_i up_i): an edge passes
// on all that lies below it. Summed from the end where all terms have one sign.
void LevelTable::add_edges(const std::vector<double>& w, const std::vector<double>& part,
                           double total) {
  const auto add_edge = [&](double sum, double flow) {
    if (flow > 0) intensity_ += sum * sum * total / flow;
  };
  double below = 0, above = 0;
  for (std::size_t n = 0; n + 1 < w.size(); ++n) {
    if (levels_[n].x < mean_) add_edge(below += part[n], w[n] * levels_[n].up);
  }
  for (std::size_t n = w.size() - 1; n > 0 && levels_[n - 1].x >= mean_; --n) {
    add_edge(above += part[n], w[n] * levels_[n].down);
  }
}

void LevelTable::find_tails() {
  if (!neighbours_only()) {
    decays_ = find_decays();
    lower_decays_ = even_ ? decays_ : mirrored().find_decays();
  }
  const auto all_forces = [](const LevelTable& table) {
    const double top = table.levels_.back().x - table.mean_;
    return table.tail_intensity(0.05 * top, 0.95 * top);
  };
  upper_tail_ = all_forces(*this);
  lower_tail_ = even_ ? upper_tail_ : all_forces(mirrored());
}

std::vector<LevelTable::Decay> LevelTable::find_decays() const {
  constexpr int forces = 12;
  const double top = levels_.back().x - mean_;
  std::vector<Decay> all;
  for (int n = 0; n < forces; ++n) {
    // In even ratios, as pulses are much larger than what they overcome.
    const double force = 0.95 * top * std::pow(0.02, 1 - n / (forces - 1.0));
    std::vector<double> f;
    for (const auto& level : levels_) f.push_back(level.x - mean_ - force);
    all.push_back({force, decay(jumps_, f, force / std::max(intensity_, peak_intensity_))});
  }
  return all;
}

// Whether theta (X - m - f) + Q has negative eigenvalues alone: the pivots of its negative are
// positive.
bool LevelTable::decays(double theta, double force) const {
  double pivot = 1, above = 0;  // of the level before, and its rate upwards
  for (const auto& [x, up, down] : levels_) {
    pivot = up + down - theta * (x - mean_ - force) - above * down / pivot;
    if (!(pivot > 0)) return false;
    above = up;
  }
  return true;
}

double LevelTable::tail_intensity(double least, double most) const {
  const double top = levels_.back().x - mean_;
  constexpr int forces = 20, halvings = 12;
  double largest = std::max(intensity_, peak_intensity_);
  for (const auto& [force, theta] : decays_) {
    // With those next to the range.
    constexpr double next = 1.5;
    if (next * force >= least && force <= next * most) largest = std::max(largest, force / theta);
  }
  if (!neighbours_only()) return largest;
  for (int n = 1; n < forces; ++n) {
    // In even ratios, as pulses are much larger than what they overcome.
    const double share = static_cast<double>(n - 1) / (forces - 2),
                 force = least > 0 ? least * std::pow(most / least, share) : share * most;
    if (!(force > 0) || force >= top) continue;
    double low = force / intensity_, high = low;
    while (!decays(low, force) && low > 1e-6 * high) low /= 2;
    while (decays(high, force)) high *= 2;
    for (int k = 0; k < halvings; ++k) {
      const double middle = (low + high) / 2;
      (decays(middle, force) ? low : high) = middle;
    }
    largest = std::max(largest, force / low);
  }
  return largest;
}

LevelTable LevelTable::within(int low, int high) const {
  if (!neighbours_only()) return *this;
  low = std::max(low, lowest());
  high = std::min(high, highest());
  LevelTable part = *this;
  part.lowest_ = low;
  part.levels_.assign(levels_.begin() + (low - lowest_), levels_.begin() + (high - lowest_ + 1));
  part.levels_.front().down = part.levels_.back().up = 0;
  if (!order_.empty()) {
    part.order_.assign(order_.begin() + (low - lowest_), order_.begin() + (high - lowest_ + 1));
  }
  return part;
}

LevelTable LevelTable::mirrored() const {
  LevelTable other = *this;
  for (std::size_t n = 0; n < levels_.size(); ++n) {
    const auto& [x, up, down] = levels_[levels_.size() - 1 - n];
    other.levels_[n] = {-x, down, up};
  }
  const int last = static_cast<int>(levels_.size()) - 1;
  std::reverse(other.jumps_.begin(), other.jumps_.end());
  for (auto& row : other.jumps_) {
    std::reverse(row.begin(), row.end());
    for (auto& jump : row) jump.to = last - jump.to;
  }
  std::reverse(other.probability_.begin(), other.probability_.end());
  std::reverse(other.order_.begin(), other.order_.end());
  std::swap(other.decays_, other.lower_decays_);
  other.lowest_ = -highest();
  other.mode_ = -mode_;
  other.mean_ = -mean_;
  std::swap(other.upper_tail_, other.lower_tail_);
  return other;
}

}  // namespace stickslip::model
