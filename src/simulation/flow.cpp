#include "stickslip/simulation/flow.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>

#include <utility>

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

constexpr std::size_t kOrder = kDragTerms, kLowOrder = 6;
constexpr double kTolerance = 1e-11;  // of the last term of a series: what follows is far smaller

// 1/n.
constexpr std::array<double, kOrder + 4> kInverse = [] {
  std::array<double, kOrder + 4> inverse{};
  for (std::size_t n = 1; n < inverse.size(); ++n) inverse[n] = 1 / static_cast<double>(n);
  return inverse;
}();

/// u(t) - u(0) = sum_{n=1}^{8} x_n t^n, where u' = force + sum_k b_k (u - u(0))^k; fewer terms
/// where they do up to `room`.
class Series {
 public:
  Series(const DragPanel& panel, double speed, double force, double room)
      : speed_(speed), reach_(room) {
    auto b = panel.coefficient;
    const double shift = speed - panel.centre;
    _Pragma("GCC unroll 8") for (std::size_t k = 0; k + 1 < kDragTerms; ++k) {
      _Pragma("GCC unroll 8") for (std::size_t n = kDragTerms - 1; n-- > k;) {
        b[n] += shift * b[n + 1];
      }
    }
    if (std::abs(b[1]) * room > 3) reach_ = 3 / std::abs(b[1]);
    x_[1] = force + b[0];
    std::array<std::array<double, kOrder>, kDragTerms> power;  // [k][n]: of t^n in (u - u(0))^k
    _Pragma("GCC unroll 8") for (std::size_t n = 1; n < kOrder; ++n) {
      power[1][n] = x_[n];
      double sum = b[1] * x_[n];
      _Pragma("GCC unroll 8") for (std::size_t k = 2; k <= n; ++k) {
        double product = 0;
        _Pragma("GCC unroll 8") for (std::size_t m = 1; m <= n - k + 1; ++m) {
          product += x_[m] * power[k - 1][n - m];
        }
        power[k][n] = product;
        sum += b[k] * product;
      }
      x_[n + 1] = sum * kInverse[n + 1];
      if (n + 1 == kLowOrder && remainder<kLowOrder>(reach_) + missing(b, reach_) <= 1) return;
    }
    shorten();
  }

  [[nodiscard]] double rate() const { return x_[1]; }
  /// The time over which the series is right.
  [[nodiscard]] double reach() const { return reach_; }
  [[nodiscard]] double change(double t) const {
    double sum = 0;
    for (std::size_t n = kOrder; n > 0; --n) sum = (sum + x_[n]) * t;
    return sum;
  }
  /// When the speed has changed by `change`, which it does before `latest`.
  [[nodiscard]] double time_of(double change, double latest) const {
    std::uintmax_t iterations = 60;
    const auto distance = [&](double t) {
      double rate = 0;
      for (std::size_t n = kOrder; n > 0; --n) rate = rate * t + static_cast<double>(n) * x_[n];
      return std::pair(this->change(t) - change, rate);
    };
    return boost::math::tools::newton_raphson_iterate(distance, std::min(change / rate(), latest),
                                                      0.0, latest, 50, iterations);
  }
  /// int u dt and int u^2 dt over [0, t].
  [[nodiscard]] std::pair<double, double> integrals(double t) const {
    double path = 0, square = 0;
    for (std::size_t n = kOrder; n > 0; --n) path = (path + x_[n] * kInverse[n + 1]) * t;
    for (std::size_t n = kOrder + 2; n > 1; --n) {
      double product = 0;
      for (std::size_t m = n > kOrder ? n - kOrder : 1; m <= std::min(n - 1, kOrder); ++m) {
        product += x_[m] * x_[n - m];
      }
      square = (square + product * kInverse[n + 1]) * t;
    }
    return {t * (speed_ + path), t * (speed_ * (speed_ + 2 * path) + square * t)};
  }

 private:
  // The last terms over what is allowed of them. Some may be 0 by chance, but not the earlier ones.
  template <std::size_t order>
  [[nodiscard]] double remainder(double h) const {
    constexpr double fall = 3e-3;  // of one term to the next
    double power = order == kOrder ? h * h * h * h * h : h * h * h, size = 0;
    _Pragma("GCC unroll 4") for (std::size_t n = order - 3; n <= order; ++n, power *= h) {
      size = fall * size + power * std::abs(x_[n]);
    }
    return size / (kTolerance * (speed_ + h * std::abs(x_[1])));
  }
  // The same of what b has in its highest powers alone.
  [[nodiscard]] double missing(const std::array<double, kDragTerms>& b, double h) const {
    const double change = h * std::abs(x_[1]), square = change * change;
    const double force = square * square * square * (std::abs(b[6]) + change * std::abs(b[7]));
    return h * force / (kTolerance * (speed_ + change));
  }
  void shorten() {
    double remaining = remainder<kOrder>(reach_);
    while (remaining > 1) {
      reach_ *= 0.95 * std::max(0.1, std::pow(remaining, -1.0 / 8));
      remaining = remainder<kOrder>(reach_);
    }
  }

  double speed_, reach_;
  std::array<double, kOrder + 1> x_{};
};

/// Steps by series, each within a panel of the drag, the last one up to where the body stops.
class Motion {
 public:
  Motion(DragTable& drag, double force, double speed)
      : drag_(drag), force_(force), speed_(speed), stopped_(speed <= 0 && force < 0) {}

  [[nodiscard]] Piece piece() const { return {time_, speed_, path_, square_, stopped_}; }
  void advance(double end, bool integrals) {
    while (!stopped_ && time_ < end) step(end, integrals);
  }

 private:
  void step(double end, bool integrals) {
    const DragPanel& panel = drag_.at(speed_);
    const double room = end - time_;
    const Series series(panel, speed_, force_, room);
    double h = series.reach(), next = speed_ + series.change(h);
    // Only a body that is pushed back stops; else the rest of the speed is below the tolerance.
    const bool bottom = panel.low == 0;
    stopped_ = bottom && next <= 0 && force_ < 0;
    if (stopped_ || next > panel.to || (next < panel.from && !bottom)) {
      next = next > panel.to ? panel.to : panel.from;
      h = series.time_of(next - speed_, h);
    }
    if (integrals) {
      const auto [path, square] = series.integrals(h);
      path_ += path;
      square_ += square;
    }
    time_ = h == room ? end : time_ + h;
    speed_ = std::max(next, 0.0);
  }

  DragTable& drag_;
  double force_, speed_, time_ = 0, path_ = 0, square_ = 0;
  bool stopped_;
};

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

// With theta = omega t, phi = int_0^1 exp(-i theta s) ds and psi = int_0^1 s exp(-i theta s) ds,
//
//   (c + i omega) int u exp(-i omega s) ds
//       = i omega t (u(0) phi + force t psi) + c exp(-i theta) int u ds,
//
// where nothing cancels however small c and omega are.
void LinearFlow::transform(double speed, double force, const Piece& piece,
                           const std::vector<double>& omega,
                           std::vector<std::complex<double>>& result) const {
  const double t = piece.time;
  for (std::size_t n = 0; n < omega.size(); ++n) {
    if (omega[n] == 0) {
      result[n] = piece.path;
      continue;
    }
    const double half = omega[n] * t / 2, sine = std::sin(half), cosine = std::cos(half);
    const std::complex<double> turn(cosine, -sine);
    const double mean = half > 0 ? sine / half : 1;
    const double bend = half > 0.02 ? (mean - cosine) / half : half * (1 - half * half / 10) / 3;
    // phi = turn mean, psi = turn (mean - i bend)/2.
    const std::complex<double> moved(mean * (speed + force * t / 2), -force * t * bend / 2);
    const std::complex<double> pushed(omega[n] * t * turn * moved);
    result[n] =
        (std::complex<double>(-pushed.imag(), pushed.real()) + c_ * piece.path * turn * turn) /
        std::complex<double>(c_, omega[n]);
  }
}

Piece GeneralFlow::move(double speed, double force, double time, bool integrals) const {
  Motion motion(table_, force, speed);
  motion.advance(time, integrals);
  return motion.piece();
}

void GeneralFlow::transform(double speed, double force, const Piece& piece,
                            const std::vector<double>& omega,
                            std::vector<std::complex<double>>& result) const {
  using Rule = boost::math::quadrature::gauss<double, 10>;
  result.assign(omega.size(), 0.0);
  if (omega.empty()) return;
  const double highest = *std::max_element(omega.begin(), omega.end());
  // The drag bends u(t) as fast as waves do.
  const double decay = drag_.steepest(std::max(speed, piece.end));
  const int panels = 1 + static_cast<int>((highest + decay) * piece.time / 3);
  const double half = piece.time / (2 * panels);
  Motion motion(table_, force, speed);
  for (int p = 0; p < panels; ++p) {
    for (int n = -5; n <= 5; ++n) {
      if (n == 0) continue;
      const auto at = static_cast<std::size_t>(std::abs(n) - 1);
      const double node = std::copysign(Rule::abscissa()[at], n);
      const double t = half * (2 * p + 1 + node);
      motion.advance(t, false);
      const double weighted = half * Rule::weights()[at] * motion.piece().end;
      for (std::size_t w = 0; w < omega.size(); ++w) {
        result[w] +=
            weighted * std::complex<double>(std::cos(omega[w] * t), -std::sin(omega[w] * t));
      }
    }
  }
}

}  // namespace stickslip::simulation
