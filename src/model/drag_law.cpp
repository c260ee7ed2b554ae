#include "stickslip/model/drag_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "stickslip/model/breaks.hpp"
#include "stickslip/model/expression.hpp"

namespace stickslip::model {
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
