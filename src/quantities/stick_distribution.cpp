#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "stickslip/linalg/dense.hpp"
#include "stickslip/quantities/durations.hpp"
#include "stickslip/quantities/engines/inversion.hpp"

namespace stickslip::quantities {
namespace {

using Complex = std::complex<double>;
using States = std::vector<double>;  // by static level, and last what has left them

constexpr double kRounding = 1e-15;
// What sums over numbers of jumps leave out, of all that rests.
constexpr double kLeast = 1e-30;
// Nodes tied together where bodies start, see GaussianNoise::projected(), are left more slowly by
// that share.
constexpr double kTied = 3e-7;
constexpr int kFewJumps = 64;  // that weights of numbers of jumps do not underflow

/// A distribution at rest with the errors that it had at first, and rounding since.
struct Resting {
  States value = {}, error = {};
  double relative = 0;                  ///< of all of it
  double of_density = 0, of_ended = 0;  ///< beside that, absolute
};

/// exp(Q t) for the static chain.
class StickingFlow {
 public:
  explicit StickingFlow(const model::Process& process) : exits_(process.exit_rates()) {
    const int lowest = process.lowest_static();
    const std::size_t count = exits_.size();
    neighbours_ = process.noise.neighbours_only();
    up_.resize(count);
    down_.resize(count);
    std::vector<double> leaves(count, 0.0);
    for (std::size_t from = 0; from < count; ++from) {
      double size = 0;
      process.noise.for_each_jump(lowest + static_cast<int>(from), [&](int level, double rate) {
        const bool inside = lowest <= level && level <= process.highest_static();
        const std::size_t to = inside ? static_cast<std::size_t>(level - lowest) : count;
        jumps_.push_back({from, to, rate});
        if (inside) (to > from ? up_ : down_)[from] += rate;
        leaves[from] += rate;
        size += std::abs(rate);
        positive_ = positive_ && rate >= 0;
      });
      rate_ = std::max(rate_, size);
    }
    for (double rate : leaves) keeps_.push_back(1 - rate / rate_);
    keeps_.push_back(1);
  }

  [[nodiscard]] double leaving(const States& states) const {
    return std::inner_product(exits_.begin(), exits_.end(), states.begin(), 0.0);
  }

  /// From one distribution to those at rising times.
  [[nodiscard]] std::vector<Resting> at(const std::vector<double>& time, Resting now) const {
    constexpr double operations = 4;
    const double jumps = rate_ * time.back() * static_cast<double>(jumps_.size()),
                 squares = operations * std::pow(static_cast<double>(exits_.size()), 3);
    if (!neighbours_ && (!positive_ || jumps > squares)) return by_squares(time, now);
    std::vector<Resting> all;
    double before = 0;
    for (double t : time) {
      now = neighbours_ ? after(now, t - before) : by_jumps(std::move(now), t - before);
      before = t;
      all.push_back(now);
    }
    return all;
  }

 private:
  struct Jump {
    std::size_t from, to;
    double rate;
  };

  [[nodiscard]] Resting by_jumps(Resting now, double time) const {
    const double jumps = rate_ * time;
    const int steps = std::max(1, static_cast<int>(std::ceil(jumps / kFewJumps)));
    double size = 0;
    for (double value : now.value) size += std::abs(value);
    for (double& error : now.error) error += 10 * kLeast * (size - now.value.back());
    for (int n = 0; n < steps; ++n) {
      for (auto* states : {&now.value, &now.error})
        *states = step(std::move(*states), jumps / steps);
    }
    now.relative += kRounding / 10 * (8 + jumps);
    now.of_density = 0;
    return now;
  }

  // Poisson-weighted sum over the number of jumps, at the largest rate or nowhere.
  [[nodiscard]] States step(States chain, double jumps) const {
    double weight = std::exp(-jumps);
    States sum(chain.size(), 0.0);
    for (int n = 0;; ++n) {
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * chain[i];
      if (n > jumps && weight < kLeast) return sum;
      States next(chain.size(), 0.0);
      for (const auto& [from, to, rate] : jumps_) next[to] += chain[from] * (rate / rate_);
      for (std::size_t i = 0; i < next.size(); ++i) next[i] += chain[i] * keeps_[i];
      chain = std::move(next);
      weight *= jumps / (n + 1);
    }
  }

  // By as many equal steps as lose no digits, or by jumps where these are few.
  [[nodiscard]] Resting after(const Resting& before, double time) const {
    constexpr int most = 1024;
    for (int steps = 1;; steps *= 2) {
      if (rate_ * time <= kFewJumps * steps) return by_jumps(before, time);
      Resting now = before;
      bool holds = true;
      for (int n = 1; n <= steps && (holds || steps == most); ++n) {
        holds = by_contour(now, time / steps, n == steps);
      }
      if (holds || steps == most) return now;
    }
  }

  // By an inverse Laplace transform. Returns whether the sums of what is kept have the size of
  // their terms, and at the `end` those of the density and of what has ended.
  bool by_contour(Resting& now, double time, bool end) const {
    static const TalbotContour contour(32);
    constexpr double most = 1e3, nothing = 1e-290;
    const std::size_t count = exits_.size();
    States value(count + 1, 0.0), error = value;
    value[count] = now.value[count];
    error[count] = now.error[count];
    double kept = 0, density = 0, ended = 0;
    for (std::size_t n = 0; n < contour.z.size(); ++n) {
      const Complex z = contour.z[n] / time, weight = contour.weight[n] / time;
      const auto inverse = inverse_pivots(z);
      const auto [rests, leaves] = add_resolvent(now.value, z, weight, inverse, value);
      add_resolvent(now.error, z, weight, inverse, error);
      kept += std::abs(rests);
      density += std::abs(leaves);
      ended += std::abs(leaves / z);
    }
    now = {std::move(value), std::move(error), now.relative, kRounding * density,
           now.of_ended + kRounding * ended};
    const double left = std::accumulate(now.value.begin(), now.value.end() - 1, 0.0);
    if (kept <= nothing) return true;
    now.relative += kRounding * kept / std::max(left, kRounding * kept);
    return kept <= most * left &&
           (!end || (density <= most * leaving(now.value) && ended <= most * now.value[count]));
  }

  // Of z - Q, without subtraction (Grassmann, Taksar and Heyman): all numbers that are added have
  // arguments between 0 and that of z.
  [[nodiscard]] std::vector<Complex> inverse_pivots(Complex z) const {
    std::vector<Complex> inverse;
    inverse.reserve(exits_.size());
    Complex ends = z + exits_[0];
    for (std::size_t i = 0; i < exits_.size(); ++i) {
      if (i > 0) ends = z + exits_[i] + down_[i] * (ends * inverse.back());
      inverse.push_back(1.0 / (ends + up_[i]));
    }
    return inverse;
  }

  struct Resolved {
    Complex rests, leaves;
  };
  // Re weight x to `sum`, x (z - Q) = states, and what has ended by the residue at z.
  Resolved add_resolvent(const States& states, Complex z, Complex weight,
                         const std::vector<Complex>& inverse, States& sum) const {
    const std::size_t count = exits_.size();
    std::vector<Complex> x(count);
    for (std::size_t i = 0; i < count; ++i) {
      x[i] = states[i];
      if (i > 0) x[i] += x[i - 1] * up_[i - 1];
      x[i] *= inverse[i];
    }
    Resolved found{0, 0};
    for (std::size_t i = count; i-- > 0;) {
      if (i + 1 < count) x[i] += x[i + 1] * (down_[i + 1] * inverse[i]);
      const Complex term = weight * x[i];
      sum[i] += term.real();
      found.rests += term;
      found.leaves += exits_[i] * term;
    }
    sum[count] += (found.leaves / z).real();
    return found;
  }

  // For chains of any jumps: powers of exp(Q h), twice as high each time.
  [[nodiscard]] std::vector<Resting> by_squares(const std::vector<double>& time,
                                                const Resting& start) const {
    constexpr int halvings = 10;  // of 1/rate: a few terms of a series are enough
    const double unit = std::exp2(-std::ceil(std::log2(rate_)) - halvings);
    std::vector<Resting> all;
    for (double t : time) all.push_back(by_jumps(start, std::fmod(t, unit)));
    auto power = short_exponential(unit);
    for (double units = 1; units <= time.back() / unit; units *= 2) {
      for (std::size_t n = 0; n < all.size(); ++n) {
        all[n].relative += 4 * kRounding;
        if (std::fmod(std::floor(time[n] / unit / units), 2) == 0) continue;
        for (auto* states : {&all[n].value, &all[n].error}) *states = *states * power;
      }
      power = power * power;
      make_stochastic(power);
    }
    return all;
  }

  [[nodiscard]] linalg::Matrix<double> short_exponential(double time) const {
    const auto size = static_cast<int>(keeps_.size());
    linalg::Matrix<double> q(size, size);
    for (const auto& [from, to, rate] : jumps_) {
      const auto row = static_cast<int>(from), column = static_cast<int>(to);
      q(row, column) += rate * time;
      q(row, row) -= rate * time;
    }
    const auto one = linalg::Matrix<double>::identity(size);
    auto sum = one;
    for (int n = 8; n >= 1; --n) sum = 1.0 / n * (q * sum) + one;
    make_stochastic(sum);
    return sum;
  }

  // Rows have the sum 1. A diagonal near 1 is what the others leave, as its own rounding would
  // double with each power.
  static void make_stochastic(linalg::Matrix<double>& a) {
    for (int r = 0; r < a.rows(); ++r) {
      double others = 0;
      for (int c = 0; c < a.columns(); ++c) others += c == r ? 0 : a(r, c);
      if (std::abs(others) < 0.5) {
        a(r, r) = 1 - others;
        continue;
      }
      const double sum = others + a(r, r);
      for (int c = 0; c < a.columns(); ++c) a(r, c) /= sum;
    }
  }

  bool neighbours_ = true, positive_ = true;
  double rate_ = 0;  // the largest of leaving a level, by the sizes of all rates
  std::vector<double> exits_, up_, down_, keeps_;
  std::vector<Jump> jumps_;
};

}  // namespace

DurationDistribution stick_distribution(const model::Process& process,
                                        const std::vector<Uncertain>& entry,
                                        const std::vector<double>& time) {
  DurationDistribution result;
  if (time.empty()) return result;
  const StickingFlow flow(process);
  Resting start;
  for (const auto& p : entry) {
    start.value.push_back(p.value);
    start.error.push_back(p.error);
  }
  for (auto* states : {&start.value, &start.error}) states->push_back(0);
  std::vector<std::size_t> order(time.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t n) { return time[n]; });
  std::vector<double> rising;
  for (std::size_t n : order) rising.push_back(time[n]);
  const auto found = flow.at(rising, std::move(start));
  result.density.resize(time.size());
  result.distribution.resize(time.size());
  const double tied = process.noise.continuous() ? kTied : 0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const auto& [value, error, rounding, of_density, of_ended] = found[n];
    const double density = flow.leaving(value), ended = value.back(),
                 rests = std::accumulate(value.begin(), value.end() - 1, 0.0),
                 late = rests > 0 ? tied * rising[n] * std::abs(density / rests) : 0,
                 relative = rounding + late;
    result.density[order[n]] = {density,
                                flow.leaving(error) + relative * std::abs(density) + of_density};
    result.distribution[order[n]] = {ended, error.back() + relative * std::abs(ended) + of_ended};
  }
  return result;
}

}  // namespace stickslip::quantities
