#include "stickslip/model/breaks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <limits>
#include <numbers>

namespace stickslip::model {
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
