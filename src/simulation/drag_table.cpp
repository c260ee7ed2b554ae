#include "stickslip/simulation/drag_table.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>

#include "stickslip/support/infinity.hpp"

namespace stickslip::simulation {
namespace {

using Coefficients = std::array<double, kDragTerms>;

constexpr double kError = 2e-14;  // of a panel, beside the size of b
constexpr double kPi = boost::math::constants::pi<double>();

double horner(const Coefficients& a, double x) {
  double sum = 0;
  for (std::size_t n = a.size(); n-- > 0;) sum = a[n] + x * sum;
  return sum;
}

// sum_k a_k T_k(s) in powers of s, by T_{k+1} = 2 s T_k - T_{k-1}.
Coefficients powers(const Coefficients& a) {
  Coefficients sum{}, before{0, 1}, now{1};  // T_{-1} = T_1
  for (double coefficient : a) {
    Coefficients next{};
    for (std::size_t n = 0; n < a.size(); ++n) {
      sum[n] += coefficient * now[n];
      next[n] = (n > 0 ? 2 * now[n - 1] : 0) - before[n];
    }
    before = now;
    now = next;
  }
  return sum;
}

}  // namespace

DragTable::DragTable(const model::Drag& drag) : drag_(drag) {
  if (drag.law) return;
  panel_.push_back({0, kInfinity, 0, kInfinity, 0, {0, -drag.linear, 0, -drag.cubic}});
}

const DragPanel& DragTable::at(double speed) {
  while (panel_.empty() || panel_.back().high <= speed) {
    const double low = panel_.empty() ? 0 : panel_.back().high,
                 high = low > 0 ? 2 * low : drag_.scale() / 16;
    floor_ = 1e-3 * std::abs(drag_(high));
    add(low, high, 0, kInfinity);
  }
  const auto holds = [&](std::size_t n) {
    return panel_[n].low <= speed && speed < panel_[n].high;
  };
  if (holds(last_)) return panel_[last_];
  const auto above = std::upper_bound(panel_.begin(), panel_.end(), speed,
                                      [](double u, const DragPanel& p) { return u < p.low; });
  last_ = static_cast<std::size_t>(above - panel_.begin()) - 1;
  return panel_[last_];
}

// Bodies cross the end of a panel by rounding at least, but never that at 0.
DragPanel DragTable::interpolant(double low, double high, double overlap) const {
  const double more = overlap * (high - low), rounding = 1e-12 * (drag_.scale() / 16 + high);
  const double from = std::max(0.0, low - more), to = high + more;
  const double half = (to - from) / 2, centre = from + half;
  constexpr auto count = static_cast<double>(kDragTerms);
  Coefficients a{};
  for (std::size_t j = 0; j < kDragTerms; ++j) {
    const double angle = kPi * (static_cast<double>(j) + 0.5) / count;
    const double value = drag_(centre + half * std::cos(angle));
    for (std::size_t k = 0; k < kDragTerms; ++k) {
      a[k] += (k > 0 ? 2 : 1) / count * value * std::cos(static_cast<double>(k) * angle);
    }
  }
  a = powers(a);
  for (std::size_t n = 0; n < kDragTerms; ++n) a[n] /= std::pow(half, n);
  return {low, high, std::max(0.0, from - rounding), to + rounding, centre, a};
}

// The largest error at places that no panel shares with its halves. At a speed u that is a double b
// is known to a rounding of u b'(u) at best, however small b is there.
double DragTable::relative_error(const DragPanel& panel) const {
  constexpr int places = 31;
  double size = std::max(floor_, panel.centre * std::abs(panel.coefficient[1])), error = 0;
  const auto look = [&](double u) {
    const double b = drag_(u);
    size = std::max(size, std::abs(b));
    error = std::max(error, std::abs(b - horner(panel.coefficient, u - panel.centre)));
  };
  for (int n = 1; n <= places; ++n) {
    look(panel.from + (panel.to - panel.from) * std::fmod(n * 0.618033988749895, 1));
  }
  const auto& all = drag_.places;
  auto next = std::upper_bound(all.begin(), all.end(), panel.from);
  for (; next != all.end() && *next < panel.to; ++next) look(*next);
  return error > 0 ? error / size : 0;  // 0 where the law is 0 throughout
}

bool DragTable::holds(const DragPanel& panel) const { return relative_error(panel) <= kError; }

double DragTable::rough_place(double low, double high) const {
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(low < middle && middle < high)) return middle;
    (holds(interpolant(low, middle, 0)) ? low : high) = middle;
  }
}

// Halves that are hardly better than their panel show the rounding of the law itself, as where
// large terms of it cancel; small features of a law look so only until panels are short.
void DragTable::add(double low, double high, int depth, double error_of_whole) {
  constexpr int is_short = 8;
  constexpr double is_small = 1e-8, hardly_better = 0.75;
  const double width = high - low;
  double error = 0;
  for (double overlap : {0.25, 0.0}) {
    const DragPanel panel = interpolant(low, high, overlap);
    error = relative_error(panel);
    const bool smallest = overlap == 0 && width <= 1e-13 * (drag_.scale() / 16 + high);
    const bool rounding = depth >= is_short && error < is_small && overlap == 0 &&
                          error > hardly_better * error_of_whole;
    if (smallest || rounding || error <= kError) return panel_.push_back(panel);
  }
  double middle = low + width / 2;
  if (depth >= 6) {
    const double rough = rough_place(low, high);
    if (std::abs(rough - middle) < 0.49 * width) middle = rough;
  }
  add(low, middle, depth + 1, error);
  add(middle, high, depth + 1, error);
}

}  // namespace stickslip::simulation
