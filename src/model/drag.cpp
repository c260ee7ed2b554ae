#include "stickslip/model/drag.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "stickslip/support/infinity.hpp"

namespace stickslip::model {
namespace {

constexpr double kFine = 1.01;  // ratio of speeds at which laws that rise are looked at

// b(h)/h at h = 2^-n, extrapolated to h = 0 in powers of h (Romberg, Ridders), from one side only:
// b may have a kink at 0, as v |v| has. Of all entries the one that agrees best with its
// neighbours, whatever the scale on which b bends.
double extrapolated_slope(const Drag& b) {
  constexpr int rows = 60;
  constexpr std::size_t columns = 10;
  std::array<double, columns> last{}, row{};
  double best = 0, least = kInfinity;
  for (int n = 0; n < rows; ++n, last = row) {
    const double h = std::ldexp(b.scale(), -n);
    row[0] = b(h) / h;
    for (std::size_t m = 1; m < columns && static_cast<int>(m) <= n; ++m) {
      row[m] = row[m - 1] + (row[m - 1] - last[m - 1]) / (std::ldexp(1, static_cast<int>(m)) - 1);
      const double change = std::max(std::abs(row[m] - row[m - 1]), std::abs(row[m] - last[m - 1]));
      if (!(change < least)) continue;
      least = change;
      best = row[m];
    }
  }
  return b.rises_until > 0 ? best : std::min(best, 0.0);
}

// Secants over intervals of one ratio down to the scale of rounding, and between places.
double steepest_secant(const Drag& b, double v) {
  constexpr double ratio = 0.7;
  std::vector<double> ends(b.places.begin(), std::lower_bound(b.places.begin(), b.places.end(), v));
  for (int n = 0; n < 40 && v > 0; ++n) ends.push_back(v * std::pow(ratio, n));
  std::sort(ends.begin(), ends.end());
  double steepest = 0;
  for (std::size_t n = 1; n < ends.size(); ++n) {
    const double width = ends[n] - ends[n - 1], rounding = 1e-12 * ends[n];
    if (width < rounding) continue;
    steepest = std::max(steepest, std::abs(b(ends[n]) - b(ends[n - 1])) / width);
  }
  return steepest;
}

// Panels of one ratio, since the scale on which b bends is not known, until two add nothing.
double integral(const Drag& b, double v) {
  using Rule = boost::math::quadrature::gauss<double, 15>;
  const auto value = [&](double u) { return b(u); };
  constexpr double nothing = 1e-18;
  double sum = 0, before = kInfinity;
  for (int n = 0; n < 60; ++n, v /= 2) {
    const double part = Rule::integrate(value, v / 2, v);
    sum += part;
    const double size = std::abs(part);
    if (std::max(size, std::exchange(before, size)) < nothing * std::abs(sum)) break;
  }
  return sum;
}

// Halving rather than a root finder: b may be constant from some velocity on. `pushed`: whether
// force + b > 0 at `low`; at `high` the sign is the opposite one.
double change_between(double low, double high, bool pushed, const Drag& b, double force) {
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(low < middle && middle < high)) return high;
    ((force + b(middle) > 0) == pushed ? low : high) = middle;
  }
}

constexpr double kNearRest = 1e-60, kFar = 1e90;  // speeds that pass for 0 and for infinity

double smallest_balance(const Drag& b, double force) {
  double low = 0;
  for (double high : b.speeds(kNearRest * b.scale(), kFar * b.scale())) {
    if (!(force + b(high) > 0)) return change_between(low, high, true, b, force);
    low = high;
  }
  return kInfinity;
}

}  // namespace

double Drag::slope_at_rest() const { return law ? extrapolated_slope(*this) : -linear; }

double Drag::steepest(double v) const {
  return law ? steepest_secant(*this, v) : linear + 3 * cubic * v * v;
}

double Drag::potential(double v) const {
  return law ? integral(*this, v) : -(linear / 2 + cubic * v * v / 4) * v * v;
}

// A law that still grows between the square root of the largest v at which it can be computed and
// that v, as log v does, is taken to grow for ever; both in units of a speed of the law.
bool Drag::bounds_velocity() const {
  if (!law) return linear > 0 || cubic > 0;
  for (int digits = 100; digits > 0; --digits) {
    const double far = (*this)(scale() * std::pow(10.0, digits));
    if (std::isnan(far)) continue;
    if (std::isinf(far)) return far < 0;
    return far < 0 && far < 1.01 * (*this)(scale() * std::pow(10.0, digits / 2.0));
  }
  return false;
}

double Drag::terminal_velocity(double force) const {
  if (force <= 0) return 0;
  if (law) return smallest_balance(*this, force);
  if (!bounds_velocity()) return kInfinity;
  const auto net = [&](double v) { return force + (*this)(v); };
  double v = kInfinity;
  if (linear > 0) v = std::fmin(v, force / linear);
  if (cubic > 0) v = std::fmin(v, std::cbrt(force / cubic));
  if (std::isinf(v)) return v;  // coefficients too small to balance anything
  if (linear > 0 && cubic > 0) {
    while (net(v) > 0) v = std::nextafter(v, kInfinity);
    std::uintmax_t iterations = 200;
    v = boost::math::tools::toms748_solve(net, 0.0, v,
                                          boost::math::tools::eps_tolerance<double>(52), iterations)
            .second;
  }
  while (net(v) > 0) v = std::nextafter(v, kInfinity);
  return v;
}

std::vector<double> Drag::balances(double force) const {
  constexpr double smallest = 1e-30;
  std::vector<double> found;
  bool pushed = force > 0;
  double low = 0;
  for (double high : speeds(smallest * rises_until, kFar * scale())) {
    const double below = std::exchange(low, high);
    if ((force + (*this)(high) > 0) == pushed) continue;
    found.push_back(change_between(below, high, pushed, *this, force));
    pushed = !pushed;
    if (!pushed && below >= rises_until) break;
  }
  return found;
}

std::vector<double> Drag::speeds(double from, double to) const {
  std::vector<double> all;
  for (double v = from; v < to; v *= v < rises_until ? kFine : 2) all.push_back(v);
  const auto first = std::upper_bound(places.begin(), places.end(), from);
  const auto middle = static_cast<std::ptrdiff_t>(all.size());
  all.insert(all.end(), first, std::lower_bound(first, places.end(), to));
  std::inplace_merge(all.begin(), all.begin() + middle, all.end());
  all.push_back(to);
  return all;
}

// 16: where nothing is known of a law.
double Drag::scale() const {
  if (std::isfinite(reach)) return reach;
  return rises_until > 0 ? rises_until : 16;
}

double Drag::highest(double v) const {
  constexpr double smallest = 1e-9;
  const double end = std::min(v, rises_until);
  double most = 0;
  if (end > 0) {
    for (double u : speeds(smallest * end, end)) most = std::max(most, (*this)(u));
  }
  return most;
}

Drag Drag::mirrored() const {
  if (!law) return *this;
  Drag other = *this;
  other.law = [b = law](double v) { return -b(-v); };
  return other;
}

Drag with_weakening(const Drag& drag, const Friction& friction) {
  if (!friction.weakens()) return drag;
  const Friction backwards = friction.mirrored();
  constexpr double rounding = 40;  // exp(-40)
  const auto& [velocity, exponent] = *friction.stribeck;
  Drag sum = drag;
  sum.law = [=](double v) {
    return drag(v) + (v < 0 ? -backwards.weakening(-v) : friction.weakening(v));
  };
  sum.linear = sum.cubic = 0;
  sum.law_is_odd = drag.odd() && friction.symmetric();
  sum.rises_until = std::max(drag.rises_until, velocity * std::pow(rounding, 1 / exponent));
  return sum;
}

}  // namespace stickslip::model
