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
    const double h = std::ldexp(16, -n);
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

// Secants over intervals of one ratio down to the scale of rounding.
double steepest_secant(const Drag& b, double v) {
  double steepest = 0;
  for (int n = 0; n < 40 && v > 0; ++n) {
    const double below = 0.7 * v;
    steepest = std::max(steepest, std::abs(b(below) - b(v)) / (v - below));
    v = below;
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

double smallest_balance(const Drag& b, double force) {
  const double ratio = b.rises_until > 0 ? kFine : 2;
  double high = 0x1p-200;
  while (force + b(high) > 0) {
    high *= ratio;
    if (high > 0x1p300) return kInfinity;
  }
  return change_between(high / ratio, high, true, b, force);
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
// that v, as log v does, is taken to grow for ever.
bool Drag::bounds_velocity() const {
  if (!law) return linear > 0 || cubic > 0;
  for (int digits = 100; digits > 0; --digits) {
    const double v = std::pow(10.0, digits);
    const double far = (*this)(v);
    if (std::isnan(far)) continue;
    if (std::isinf(far)) return far < 0;
    return far < 0 && far < 1.01 * (*this)(std::sqrt(v));
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
  double high = smallest * rises_until;
  while (high < 0x1p300) {
    const double low = high;
    high *= low < rises_until ? kFine : 2;
    if ((force + (*this)(high) > 0) == pushed) continue;
    found.push_back(change_between(low, high, pushed, *this, force));
    pushed = !pushed;
    if (!pushed && low >= rises_until) break;
  }
  return found;
}

double Drag::highest(double v) const {
  constexpr double smallest = 1e-9;
  const double end = std::min(v, rises_until);
  double most = 0;
  double u = end;
  while (u > smallest * end) {
    most = std::max(most, (*this)(u));
    u /= kFine;
  }
  return most;
}

std::optional<double> Drag::asymmetry() const {
  if (!law) return std::nullopt;
  constexpr double rounding = 1e-12;
  const double far = std::min(reach, 1e6);
  const double size = std::max(std::abs(law(far)), std::abs(law(-far)));
  constexpr int places = 680;  // down to 1e-9 of it
  for (int n = 0; n < places; ++n) {
    const double v = far * std::pow(0.97, n);
    const double sum = std::abs(law(v) + law(-v));
    if (!(sum <= rounding * (std::abs(law(v)) + 1e-3 * size))) return v;
  }
  return std::nullopt;
}

Drag Drag::mirrored() const {
  if (!law) return *this;
  return {linear, cubic,      [b = law](double v) { return -b(-v); }, reach, law_is_odd,
          breaks, rises_until};
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
