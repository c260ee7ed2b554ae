#include "stickslip/model/drag.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "stickslip/model/expression.hpp"
#include "stickslip/model/noise_chain.hpp"

namespace stickslip::model {

double Stribeck::share(double v) const { return -std::expm1(-std::pow(v / velocity, exponent)); }

double Stribeck::share_by_velocity(double v) const {
  const double power = std::pow(v / velocity, exponent);
  return -exponent / velocity * power * std::exp(-power);
}

bool Friction::symmetric() const {
  return mu_s_minus.value_or(mu_s) == mu_s && mu_d_minus.value_or(mu_d) == mu_d;
}

bool Friction::weakens() const {
  const Friction backwards = mirrored();
  return stribeck && (mu_s > mu_d || backwards.mu_s > backwards.mu_d);
}

Friction Friction::mirrored() const {
  return {mu_s_minus.value_or(mu_s), mu_d_minus.value_or(mu_d), mu_s, mu_d, stribeck};
}

double Friction::net_force(double level, double bias) const {
  return snapped_difference(level, at_rest() - bias);
}

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

namespace {

constexpr double kNegligible = 1e-13;

double value_at(const Drag& b, double v) {
  const double value = b(v);
  if (std::isfinite(value)) return value;
  throw UnfitLaw(fmt::format("is {} at v = {:g}; drag must be finite at every velocity that can "
                             "occur",
                             std::isnan(value) ? "not a number" : "infinite", v),
                 "write for example exp(-abs(v)) for exp(abs(v)), or abs(v)^1.5 for v^1.5");
}

void require_zero_at_rest(const Drag& b, double mu_d) {
  const double value = value_at(b, 0);
  if (std::abs(value) <= kNegligible * mu_d) return;
  throw UnfitLaw(fmt::format("is {:g} at v = 0; drag must vanish at rest", value),
                 "leave constants out: dry friction is -mu_d");
}

// The law on one side, seen with v > 0.
struct Side {
  const Drag& b;
  double sign;
  [[nodiscard]] double operator()(double v) const { return sign * value_at(b, sign * v); }
};

// Where `force` no longer accelerates, with as much again for steps that overshoot; or where
// exp(-int (F - |bias| - b)/intensity), which bounds the density, is below exp(-51) of its largest
// value.
double reach_of(const Side& b, double force, const Friction& friction, double bias,
                double intensity) {
  constexpr double ratio = 1.02, far = 1e6, farthest = 1e100;
  const double mu_d = friction.mu_d, drop = 51 * intensity,
               scale = intensity / (mu_d > 0 ? mu_d : friction.mu_s);
  double left = drop, slope = 1, held = 0;
  for (double v = 1e-12 * scale; v < far * scale || (slope > 0 && v < farthest * scale);
       v *= ratio) {
    const double drag = -b(v);
    if (force <= drag) return 2 * v;
    slope = friction(v) - std::abs(bias) + drag;
    left = std::min(drop, left - slope * v * (1 - 1 / ratio));
    if (left < 0) return v;
    if (slope > 0) held = v;
  }
  const std::string driven =
      bias == 0 ? fmt::format("drives a body for ever from about v = {:.2g} on", b.sign * held)
                : fmt::format("does not hold a body that the mean force {:g} drives", bias);
  throw UnfitLaw(fmt::format("{}: it is {:g} at v = {:g}, and friction takes {:g}", driven,
                             b.sign * b(far * scale) + 0.0, b.sign * far * scale, mu_d),
                 "check the signs, as in \"-v - 0.1*v*abs(v)\"; take a bias and noise of a smaller "
                 "mean, or a drag that grows");
}

// Looks at all speeds that show the law: b must be finite there.
bool rises(const Side& b, const std::vector<double>& speeds, double mu_d) {
  bool found = false;
  double before = 0;
  for (double v : speeds) {
    const double now = b(v);
    found = found || now > before + kNegligible * (std::abs(before) + mu_d);
    before = now;
  }
  return found;
}

[[noreturn]] void refuse_slope(const Side& b, double v, double slope) {
  throw UnfitLaw(fmt::format("has a slope of {:.1e} or more at v = {:.9g}, where it is infinitely "
                             "steep; motion needs a bounded slope",
                             -slope, b.sign * v),
                 "smooth it, for example v/sqrt(abs(v) + 0.01) for sqrt(abs(v)), or tanh(v/0.01) "
                 "for sign(v)");
}

// At rest, where b/v settles unless it grows without bound, as that of v^0.99 does.
void require_slope_at_rest(const Side& b) {
  const auto slope = [&b](double part) { return b(part * b.b.scale()) / (part * b.b.scale()); };
  for (double part : {1e-8, 1e-40, 1e-80}) {
    if (!(std::abs(slope(part / 100)) > 1.02 * std::abs(slope(part)))) return;
  }
  refuse_slope(b, 1e-10 * b.b.scale(), slope(1e-10));
}

// At kinks slopes on both sides are bounded.
void require_bounded_slope(const Side& b, const Break& at) {
  constexpr double near = 1e-12, steep = 1e-8;
  (void)b(at.v);
  const double side = at.kind == Break::Kind::jump ? near : steep;
  const double before = b((1 - side) * at.v), after = b((1 + side) * at.v);
  if (at.kind == Break::Kind::kink) return;
  if (at.kind != Break::Kind::jump || after > before) {
    refuse_slope(b, at.v, (after - before) / (2 * side * at.v));
  }
  throw UnfitLaw(
      fmt::format("jumps from {:.9g} to {:.9g} at v = {:.9g}; there forces on both sides "
                  "can hold a body, and no density shows how long",
                  b.sign * before, b.sign * after, b.sign * at.v),
      "smooth it, for example tanh((v - 0.5)/0.01) for sign(v - 0.5)");
}

// What the formula is like on either side.
void examine(const Expression& b, Drag& drag, double mu_d) {
  std::vector<Break> kinks;
  bool rising = false;
  for (double sign : {1.0, -1.0}) {
    const Side side{drag, sign};
    const Shape shape = shape_of(b, {0}, 0, sign, drag.reach);
    constexpr std::size_t most = 64;
    for (const Break& at : shape.breaks) require_bounded_slope(side, at);
    Drag looked_at{.reach = drag.reach, .rises_until = drag.reach, .places = shape.places};
    const auto speeds = looked_at.speeds(1e-12 * drag.reach, drag.reach);
    rising = rises(side, speeds, mu_d) || rising;
    require_slope_at_rest(side);
    if (shape.breaks.size() > most) {
      throw UnfitLaw(fmt::format("has more than {} kinks", most),
                     "take one with fewer, or smooth it");
    }
    if (!shape.resolved) {
      throw UnfitLaw(
          fmt::format("changes too often up to v = {:.2g} to be resolved", sign * drag.reach),
          "take one with fewer or wider features");
    }
    merge(kinks, shape.breaks);
    merge(drag.places, shape.places);
  }
  for (const Break& kink : kinks) drag.breaks.push_back(kink.v);
  if (rising) drag.rises_until = drag.reach;
}

Expression read(const std::string& text, const Friction& friction, double tau) {
  try {
    return {text, {"v"}, {{"mu_s", friction.mu_s}, {"mu_d", friction.mu_d}, {"tau", tau}}};
  } catch (const std::invalid_argument& error) {
    throw UnfitLaw(error.what(),
                   "write b in v, mu_s, mu_d and tau, for example \"-v - 0.1*v*abs(v)\"");
  }
}

}  // namespace

Drag parse_drag(const std::string& text, const Friction& friction, double tau, double force,
                double bias, double intensity) {
  const Expression b = read(text, friction, tau);
  Drag drag{0, 0, [b](double v) { return b({v}); }, 0, b.odd()};
  const Friction backwards = friction.mirrored();
  const double mu_d = std::min(friction.mu_d, backwards.mu_d);
  const Friction least{std::min(friction.mu_s, backwards.mu_s), mu_d, {}, {}, friction.stribeck};
  require_zero_at_rest(drag, mu_d);
  for (double sign : {1.0, -1.0}) {
    drag.reach = std::max(drag.reach, reach_of({drag, sign}, force, least, bias, intensity));
  }
  examine(b, drag, mu_d);
  return drag;
}

}  // namespace stickslip::model
