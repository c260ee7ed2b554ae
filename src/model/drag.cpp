#include "stickslip/model/drag.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace stickslip::model {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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
  return std::min(best, 0.0);
}

// Secants over intervals of one ratio down to the scale of rounding.
double steepest_secant(const Drag& b, double v) {
  double steepest = 0;
  for (int n = 0; n < 40 && v > 0; ++n) {
    const double below = 0.7 * v;
    steepest = std::max(steepest, (b(below) - b(v)) / (v - below));
    v = below;
  }
  return steepest;
}

// Panels of one ratio, since the scale on which b bends is not known.
double integral(const Drag& b, double v) {
  using Rule = boost::math::quadrature::gauss<double, 15>;
  const auto value = [&](double u) { return b(u); };
  double sum = 0;
  for (int n = 0; n < 60; ++n, v /= 2) sum += Rule::integrate(value, v / 2, v);
  return sum;
}

// Halving rather than a root finder: b may be constant from some velocity on.
double smallest_balance(const Drag& b, double force) {
  const auto pushed = [&](double v) { return force + b(v) > 0; };
  double high = 0x1p-200;
  while (pushed(high)) {
    high *= 2;
    if (high > 0x1p300) return kInfinity;
  }
  double low = high / 2;
  for (double middle = 0.75 * high; low < middle && middle < high; middle = (low + high) / 2) {
    (pushed(middle) ? low : high) = middle;
  }
  return high;
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
    return far < 1.01 * (*this)(std::sqrt(v));
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
  return {linear, cubic, [b = law](double v) { return -b(-v); }, reach, law_is_odd, breaks};
}

}  // namespace stickslip::model
