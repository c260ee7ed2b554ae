#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <limits>
#include <numbers>

#include "stickslip/base/text.hpp"
#include "stickslip/model/expression.hpp"

namespace stickslip::model {
namespace {

constexpr Interval kAll{-kInfinity, kInfinity};

// Functions of the standard library are right to about one unit in the last place.
Interval widened(double low, double high) {
  constexpr double rounding = 2 * std::numeric_limits<double>::epsilon(), least = 1e-320;
  constexpr double most = std::numeric_limits<double>::max();
  if (std::isnan(low) || std::isnan(high)) return kAll;
  low = std::min(low, most);
  high = std::max(high, -most);
  return {low - rounding * std::abs(low) - least, high + rounding * std::abs(high) + least};
}

Interval operator+(const Interval& a, const Interval& b) {
  if (a.is_zero()) return b;
  if (b.is_zero()) return a;
  return widened(a.low + b.low, a.high + b.high);
}

Interval operator-(const Interval& a) { return {-a.high, -a.low}; }
Interval operator-(const Interval& a, const Interval& b) { return a + -b; }

// What is unbounded is finite all the same, so that 0 times it is 0.
double product(double x, double y) { return x == 0 || y == 0 ? 0 : x * y; }

Interval operator*(const Interval& a, const Interval& b) {
  if (a.is_zero() || b.is_zero()) return {};
  const auto [low, high] = std::minmax({product(a.low, b.low), product(a.low, b.high),
                                        product(a.high, b.low), product(a.high, b.high)});
  return widened(low, high);
}

Interval inverse(const Interval& a) {
  return a.holds_zero() ? kAll : widened(1 / a.high, 1 / a.low);
}

Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

Interval within(const Interval& a, double low, double high) {
  return {std::clamp(a.low, low, high), std::clamp(a.high, low, high)};
}

Interval point(double x) { return {x, x}; }

Jet anything(Interval value = kAll) {
  Jet f;
  f.at.fill(kAll);
  f.at[0] = value;
  f.rough = true;
  return f;
}

// Either of the two, with a break between.
Jet hull(const Jet& f, const Jet& g) {
  Jet both;
  for (std::size_t k = 0; k <= kJetOrder; ++k) both.at[k] = hull(f.at[k], g.at[k]);
  both.rough = true;
  return both;
}

Jet step(double low, double high) {
  Jet f;
  f.at[0] = {low, high};
  f.rough = true;
  return f;
}

// sum_(j = 1 ... k) j u_j w_(k-j) / k, the coefficient k of g with g' = w u'.
Interval chained(const Jet& u, const Jet& w, std::size_t k) {
  Interval sum;
  for (std::size_t j = 1; j <= k; ++j) {
    sum = sum + point(static_cast<double>(j)) * u.at[j] * w.at[k - j];
  }
  return sum * inverse(point(static_cast<double>(k)));
}

Interval rising(const Jet& f, double (*function)(double)) {
  return widened(function(f.at[0].low), function(f.at[0].high));
}

// A rising function g of u, from g' = w u'.
Jet chain(const Jet& u, const Jet& w, double (*function)(double)) {
  Jet g;
  g.rough = u.rough || w.rough;
  g.at[0] = rising(u, function);
  for (std::size_t k = 1; k <= kJetOrder; ++k) g.at[k] = chained(u, w, k);
  return g;
}

struct Circular {
  Jet sine, cosine;
};

// Whether a + 2 pi n lies in the interval for a whole n.
bool passes(const Interval& x, double a) {
  constexpr double turn = 2 * std::numbers::pi;
  return std::ceil((x.low - a) / turn - 1e-9) <= std::floor((x.high - a) / turn + 1e-9);
}

Interval values_of_sine(const Interval& x) {
  constexpr double quarter = std::numbers::pi / 2;
  if (!(x.size() < 1e15)) return {-1, 1};
  const auto [low, high] = std::minmax({std::sin(x.low), std::sin(x.high)});
  return within(widened(passes(x, -quarter) ? -1 : low, passes(x, quarter) ? 1 : high), -1, 1);
}

Circular circular(const Jet& f) {
  Circular g;
  const Interval x = f.at[0];
  g.sine.at[0] = values_of_sine(x);
  g.cosine.at[0] = x.is_zero() ? point(1) : values_of_sine(x + point(std::numbers::pi / 2));
  g.sine.rough = g.cosine.rough = f.rough;
  for (std::size_t k = 1; k <= kJetOrder; ++k) {
    g.sine.at[k] = chained(f, g.cosine, k);
    g.cosine.at[k] = -chained(f, g.sine, k);
  }
  return g;
}

// g and w with g' = w u', w' = 2 sign g w u', from their values: w is small where tanh is flat.
Jet tangent(const Jet& u, Interval value, Interval slope, double sign) {
  Jet g, w;
  g.rough = u.rough;
  g.at[0] = value;
  w.at[0] = slope;
  for (std::size_t k = 1; k <= kJetOrder; ++k) {
    g.at[k] = chained(u, w, k);
    w.at[k] = point(2 * sign) * chained(u, g * w, k);
  }
  return g;
}

Jet squared(const Jet& f) {
  Jet g = f * f;
  g.at[0].low = std::max(g.at[0].low, 0.0);
  return g;
}

Jet whole_power(const Jet& f, int n) {
  if (n == 0) return Jet(1);
  if (n == 1) return f;
  return n % 2 ? f * whole_power(f, n - 1) : squared(whole_power(f, n / 2));
}

// u g' = p g u'.
Jet real_power(const Jet& f, double p) {
  const Interval u = f.at[0];
  if (f.is_zero() && p > 0) return Jet(0);
  if (u.high < 0) return anything();
  if (u.low <= 0) return anything(p > 0 ? Interval{0, std::pow(u.high, p)} : kAll);
  Jet g;
  g.rough = f.rough;
  g.at[0] = p > 0 ? widened(std::pow(u.low, p), std::pow(u.high, p))
                  : widened(std::pow(u.high, p), std::pow(u.low, p));
  for (std::size_t k = 1; k <= kJetOrder; ++k) {
    Interval sum;
    for (std::size_t j = 1; j <= k; ++j) {
      const auto order = static_cast<double>(j), rest = static_cast<double>(k - j);
      sum = sum + (point(p) * point(order) - point(rest)) * f.at[j] * g.at[k - j];
    }
    g.at[k] = sum * inverse(point(static_cast<double>(k)) * u);
  }
  return g;
}

// f - g, exactly where both are numbers: what is equal is seen to be so.
Interval difference(const Jet& f, const Jet& g) {
  const Interval &a = f.at[0], &b = g.at[0];
  return a.is_point() && b.is_point() ? point(a.low - b.low) : a - b;
}

}  // namespace

bool Jet::is_zero() const {
  return std::all_of(at.begin(), at.end(), [](const Interval& a) { return a.is_zero(); });
}

bool Jet::is_constant() const {
  return at[0].is_point() &&
         std::all_of(at.begin() + 1, at.end(), [](const Interval& a) { return a.is_zero(); });
}

Jet operator+(const Jet& f, const Jet& g) {
  Jet sum;
  sum.rough = f.rough || g.rough;
  for (std::size_t k = 0; k <= kJetOrder; ++k) sum.at[k] = f.at[k] + g.at[k];
  return sum;
}

Jet operator-(const Jet& f) {
  Jet g = f;
  for (Interval& a : g.at) a = -a;
  return g;
}

Jet operator-(const Jet& f, const Jet& g) { return f + -g; }

Jet operator*(const Jet& f, const Jet& g) {
  Jet all;
  all.rough = (f.rough && !g.is_zero()) || (g.rough && !f.is_zero());
  for (std::size_t k = 0; k <= kJetOrder; ++k) {
    for (std::size_t j = 0; j <= k; ++j) all.at[k] = all.at[k] + f.at[j] * g.at[k - j];
  }
  return all;
}

Jet operator/(const Jet& f, const Jet& g) {
  if (g.at[0].holds_zero()) return anything();
  constexpr double large = 1e200;  // f/g is 0, however g grows
  const Interval scale = inverse(g.at[0]);
  if (scale.size() < 1 / large && f.at[0].size() < std::sqrt(large)) return Jet(0);
  Jet ratio;
  ratio.rough = f.rough || g.rough;
  for (std::size_t k = 0; k <= kJetOrder; ++k) {
    Interval rest = f.at[k];
    for (std::size_t j = 1; j <= k; ++j) rest = rest - g.at[j] * ratio.at[k - j];
    ratio.at[k] = rest * scale;
  }
  return ratio;
}

Jet pow(const Jet& f, const Jet& g) {
  if (!g.is_constant()) return exp(g * log(f));
  const double p = g.at[0].low;
  constexpr double most = 1000;
  if (p != std::round(p) || std::abs(p) > most) return real_power(f, p);
  return p < 0 ? Jet(1) / whole_power(f, static_cast<int>(-p))
               : whole_power(f, static_cast<int>(p));
}

Jet exp(const Jet& f) {
  Jet g;
  g.rough = f.rough;
  g.at[0] = rising(f, std::exp);
  for (std::size_t k = 1; k <= kJetOrder; ++k) g.at[k] = chained(f, g, k);
  return g;
}

Jet log(const Jet& f) {
  if (f.at[0].low <= 0) return anything();
  return chain(f, Jet(1) / f, std::log);
}

Jet sqrt(const Jet& f) { return real_power(f, 0.5); }
Jet sin(const Jet& f) { return circular(f).sine; }
Jet cos(const Jet& f) { return circular(f).cosine; }

Jet tan(const Jet& f) {
  const Interval cosine = cos(f).at[0];
  if (cosine.holds_zero()) return anything();
  const Interval secant = inverse(cosine);
  return tangent(f, rising(f, std::tan), secant * secant, 1);
}

Jet tanh(const Jet& f) {
  const auto slope = [](double x) { return 1 / std::cosh(x) / std::cosh(x); };
  const auto [flat, steep] = std::minmax({slope(f.at[0].low), slope(f.at[0].high)});
  return tangent(f, within(rising(f, std::tanh), -1, 1),
                 widened(flat, f.at[0].holds_zero() ? 1 : steep), -1);
}

Jet asin(const Jet& f) {
  if (f.at[0].size() >= 1) return anything({-2, 2});
  return chain(f, Jet(1) / sqrt(Jet(1) - squared(f)), std::asin);
}

Jet acos(const Jet& f) { return Jet(std::numbers::pi / 2) - asin(f); }

Jet atan(const Jet& f) { return chain(f, Jet(1) / (Jet(1) + squared(f)), std::atan); }

Jet atan2(const Jet& f, const Jet& g) {
  constexpr double half_turn = std::numbers::pi;
  if (g.at[0].low > 0) return atan(f / g);
  if (f.at[0].low > 0) return Jet(half_turn / 2) - atan(g / f);
  if (f.at[0].high < 0) return Jet(-half_turn / 2) - atan(g / f);
  return anything({-4, 4});
}

Jet sinh(const Jet& f) {
  Jet g = (exp(f) - exp(-f)) * Jet(0.5);
  g.at[0] = rising(f, std::sinh);
  return g;
}

Jet cosh(const Jet& f) {
  Jet g = (exp(f) + exp(-f)) * Jet(0.5);
  g.at[0].low = std::max(g.at[0].low, 1.0);
  return g;
}

Jet asinh(const Jet& f) { return chain(f, Jet(1) / sqrt(Jet(1) + squared(f)), std::asinh); }

Jet acosh(const Jet& f) {
  if (f.at[0].low <= 1) return anything();
  return chain(f, Jet(1) / sqrt(squared(f) - Jet(1)), std::acosh);
}

Jet atanh(const Jet& f) {
  if (f.at[0].size() >= 1) return anything();
  return chain(f, Jet(1) / (Jet(1) - squared(f)), std::atanh);
}

Jet abs(const Jet& f) {
  if (f.at[0].low >= 0) return f;
  if (f.at[0].high <= 0) return -f;
  Jet g = hull(f, -f);
  g.at[0].low = 0;
  return g;
}

Jet sign(const Jet& f) {
  if (f.at[0].is_zero()) return Jet(0);
  if (f.at[0].low >= 0) return Jet(1);
  if (f.at[0].high <= 0) return Jet(-1);
  return step(-1, 1);
}

Jet rint(const Jet& f) {
  const double low = std::floor(f.at[0].low + 0.5), high = std::floor(f.at[0].high + 0.5);
  return low == high ? Jet(low) : step(low, high);
}

Jet minimum(const Jet& f, const Jet& g) {
  const Interval d = difference(f, g);
  if (d.high <= 0) return f;
  if (d.low >= 0) return g;
  Jet least = hull(f, g);
  least.at[0].high = std::min(f.at[0].high, g.at[0].high);
  return least;
}

Jet less(const Jet& f, const Jet& g) {
  const Interval d = difference(f, g);
  if (d.low >= 0) return Jet(0);
  if (d.high <= 0) return Jet(1);
  return step(0, 1);
}

Jet equal(const Jet& f, const Jet& g) {
  const Interval d = difference(f, g);
  if (d.is_zero()) return Jet(1);
  return d.low >= 0 || d.high <= 0 ? Jet(0) : step(0, 1);
}

Jet both(const Jet& f, const Jet& g) {
  const Jet zero(0), one(1);
  return choose(f, choose(g, one, zero), zero);
}

Jet choose(const Jet& condition, const Jet& f, const Jet& g) {
  if (condition.at[0].is_zero()) return g;
  return condition.at[0].holds_zero() ? hull(f, g) : f;
}

namespace {

// Speeds that pass for 0, as parts of the reach: where there may be a break, and where not. At
// small speeds functions such as 1 - cos(v) consist of rounding.
constexpr double kSlowest = 1e-12, kSlow = 1e-8;
constexpr double kLeast = 1e-9;  // distance of two breaks, relative

struct Cell {
  double low, high;
  [[nodiscard]] double middle() const { return low + (high - low) / 2; }
};

/// Bisects the speeds until the formula is known on each cell.
class Search {
 public:
  Search(const Expression& f, const std::vector<double>& values, std::size_t v, double sign,
         double reach)
      : f_(f),
        values_(values),
        jets_(values.begin(), values.end()),
        v_(v),
        sign_(sign),
        reach_(reach) {
    constexpr double ratio = 0.8;
    constexpr int places = 120;
    for (int n = 0; n < places; ++n) {
      const double value = std::abs(at(reach * std::pow(ratio, n)));
      if (std::isfinite(value)) largest_ = std::max(largest_, value);
    }
  }

  // The widest cells first: where they become too many, all are as fine.
  [[nodiscard]] Shape shape() {
    constexpr int most = 50000;
    std::deque<Cell> open{{0, reach_}};
    int count = 0;
    for (; !open.empty() && count < most; ++count) {
      const Cell cell = open.front();
      open.pop_front();
      const Jet jet = seen(cell);
      const double slow = (jet.rough ? kSlowest : kSlow) * reach_;
      if (cell.high <= slow || is_known(jet, cell)) {
        add_places(cell);
      } else if (jet.rough && cell.high - cell.low < kLeast * cell.high) {
        add_break(place(cell));
      } else {
        open.push_back({cell.low, cell.middle()});
        open.push_back({cell.middle(), cell.high});
      }
    }
    shape_.resolved = open.empty();
    std::sort(shape_.places.begin(), shape_.places.end());
    return std::move(shape_);
  }

 private:
  double at(double speed) {
    values_[v_] = sign_ * speed;
    return f_(values_);
  }

  [[nodiscard]] Jet seen(const Cell& cell) {
    jets_[v_] = sign_ > 0 ? Jet({cell.low, cell.high}, 1) : Jet({-cell.high, -cell.low}, -1);
    return f_.jet(jets_);
  }

  // By the remainder of interpolation at 8 Chebyshev nodes.
  [[nodiscard]] bool is_known(const Jet& jet, const Cell& cell) {
    constexpr double exact = 1e-10, beside_largest = 1e-4;
    if (jet.rough) return false;
    const double error = jet.at[kJetOrder].size() * 2 *
                         std::pow((cell.high - cell.low) / 4, static_cast<double>(kJetOrder));
    const double size = std::max(std::abs(at(cell.low)), std::abs(at(cell.high)));
    if (std::isfinite(size)) largest_ = std::max(largest_, size);
    const double exactly = exact * std::max(size, beside_largest * largest_);
    return std::min(error, jet.at[0].high - jet.at[0].low) <= exactly;
  }

  void add_places(const Cell& cell) {
    for (double v : {cell.middle(), cell.high}) shape_.places.push_back(v);
  }

  // Bisects on, down to rounding. Of decimal numbers next to it, the shortest is meant.
  [[nodiscard]] double place(Cell cell) {
    while (cell.low < cell.middle() && cell.middle() < cell.high) {
      const Cell lower{cell.low, cell.middle()}, upper{cell.middle(), cell.high};
      const bool below = seen(lower).rough;
      if (below == seen(upper).rough) break;
      cell = below ? lower : upper;
    }
    const double v = cell.middle();
    const double decimal = std::strtod(fmt::format("{:.12g}", v).c_str(), nullptr);
    return std::abs(decimal - v) < 4e-15 * v ? decimal : v;
  }

  void add_break(double v) {
    if (v >= (1 - kLeast) * reach_) return;
    for (double part : {-1e-3, -1e-6, 1e-6, 1e-3}) shape_.places.push_back((1 + part) * v);
    if (!smooth(v)) merge(shape_.breaks, {{v, kind(v)}});
  }

  // As abs(v - 1)^2 is.
  bool smooth(double v) {
    constexpr double rounding = 1e-12;
    const FunctionOfSpeed f = [this](double speed) { return at(speed); };
    const double size = std::max(std::abs(f(0.999 * v)), std::abs(f(1.001 * v)));
    return std::ranges::all_of(std::array{1e-3, 1e-6, 1e-8}, [&](double part) {
      return interpolation_error(f, (1 - part) * v, (1 + part) * v) <= rounding * size;
    });
  }

  // The steepest slope on either side of v.
  double slope(double v, double part) {
    const auto beside = [&](double side) {
      return std::abs(at((1 + 2 * side) * v) - at((1 + side) * v)) / std::abs(side);
    };
    return std::max(beside(part), beside(-part));
  }

  // A jump is left of all that changes nearby.
  Break::Kind kind(double v) {
    constexpr double near = 1e-12, far = 1e-8, farther = 1e-5, rounding = 1e-12;
    const auto beside = [&](double part) {
      return std::max(std::abs(at((1 + part) * v)), std::abs(at((1 - part) * v)));
    };
    if (!(beside(near) <= 30 * beside(far))) return Break::Kind::pole;
    const double size = beside(1e-3), above = at((1 + near) * v), below = at((1 - near) * v);
    const double besides =
        std::max(std::abs(at((1 + far) * v) - above), std::abs(at((1 - far) * v) - below));
    if (std::abs(above - below) > std::max(rounding * size, 0.5 * besides))
      return Break::Kind::jump;
    const double steepest = slope(v, far);
    if (steepest * far > rounding * size && steepest > 2 * slope(v, farther)) {
      return Break::Kind::steep;
    }
    return Break::Kind::kink;
  }

  const Expression& f_;
  std::vector<double> values_;
  std::vector<Jet> jets_;
  std::size_t v_;
  double sign_, reach_;
  double largest_ = std::numeric_limits<double>::min() * 1e10;  // value that was seen
  Shape shape_;
};

}  // namespace

bool Break::same_as(const Break& other) const {
  return std::abs(v - other.v) <= 4 * kLeast * std::max(v, other.v);
}

// By the barycentric formula. The middle, where marks lie, is not among the places.
double interpolation_error(const FunctionOfSpeed& f, double a, double b,
                           const std::vector<double>& places) {
  constexpr int count = 8;
  const auto value = [&](double t) { return f(a + (b - a) * (1 + t) / 2); };
  std::array<double, count> node{}, weight{}, at_node{};
  for (int n = 0; n < count; ++n) {
    const double angle = (2 * n + 1) * std::numbers::pi / (2 * count);
    node[n] = std::cos(angle);
    weight[n] = (n % 2 ? -1 : 1) * std::sin(angle);
    at_node[n] = value(node[n]);
  }
  double largest = 0;
  const auto look = [&](double t, double exact) {
    double sum = 0, weights = 0;
    for (int n = 0; n < count; ++n) {
      if (t == node[n]) return;
      sum += weight[n] / (t - node[n]) * at_node[n];
      weights += weight[n] / (t - node[n]);
    }
    const double error = std::abs(sum / weights - exact);
    largest =
        std::isfinite(error) ? std::max(largest, error) : std::numeric_limits<double>::quiet_NaN();
  };
  for (int m : {0, 1, 2, 3, 5, 6, 7, 8}) {
    const double t = std::cos(m * std::numbers::pi / count);
    look(t, value(t));
  }
  auto next = std::upper_bound(places.begin(), places.end(), a);
  for (; next != places.end() && *next < b; ++next) look(2 * (*next - a) / (b - a) - 1, f(*next));
  return largest;
}

void merge(std::vector<Break>& found, const std::vector<Break>& more) {
  for (const Break& next : more) {
    const auto known = std::find_if(found.begin(), found.end(),
                                    [&next](const Break& b) { return b.same_as(next); });
    if (known == found.end()) {
      found.push_back(next);
    } else {
      known->kind = std::max(known->kind, next.kind);
    }
  }
  std::sort(found.begin(), found.end(), [](const Break& a, const Break& b) { return a.v < b.v; });
}

void merge(std::vector<double>& places, const std::vector<double>& more) {
  places.insert(places.end(), more.begin(), more.end());
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

Shape shape_of(const Expression& f, const std::vector<double>& values, std::size_t v, double sign,
               double reach) {
  return Search(f, values, v, sign, reach).shape();
}

}  // namespace stickslip::model
