#include "stickslip/model/breaks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <regex>

#include "stickslip/support/infinity.hpp"

namespace stickslip::model {
namespace {

constexpr double kLeast = 1e-9;  // distance of two breaks, relative
// Below this part of the reach functions such as 1 - cos(v) consist of rounding.
constexpr double kSlowest = 1e-6;
constexpr std::size_t kSteps = 5;  // that show an order

struct Interval {
  double low, high, error, rise;

  Interval(const FunctionOfSpeed& f, double a, double b)
      : low(a), high(b), error(interpolation_error(f, a, b)), rise(std::abs(f(b) - f(a))) {}
  [[nodiscard]] double width() const { return high - low; }
  [[nodiscard]] double size() const { return std::isnan(error) ? kInfinity : error; }
  [[nodiscard]] double at(double t) const { return low + t * (high - low); }
  [[nodiscard]] bool divides() const { return width() > 1e-12 * high; }
  /// What rounding of v does to f.
  [[nodiscard]] double rounding() const { return 2e-15 * high * (rise + error) / width(); }
};

/// Finds the breaks of one function.
class Search {
 public:
  Search(const FunctionOfSpeed& f, const std::vector<double>& marks, double largest)
      : f_(f), marks_(marks), largest_(largest) {}

  /// Those between a and b.
  void look(double a, double b, int depth = 0) {
    constexpr int deepest = 20;
    if (!(b - a > kLeast * b) || depth > deepest) return;
    const Interval all(f_, a, b);
    // Around a zero of f its rounding is that of larger values nearby.
    const double size = std::max(std::abs(f_(0.99 * a)), std::abs(f_(b)));
    constexpr double seen = 1e-7, rounding = 1e-11, smallest = 1e-200;
    if (!(all.error > seen * size + smallest)) return;
    const auto [bracket, order] = narrow(all, rounding * std::max(size, all.error));
    constexpr double smooth = 3.5;
    double gap = 0;
    if (order < smooth) {
      const Break next = place(bracket, order, std::max(size, all.error));
      if (!rounded(next, bracket.error)) merge(found, {next});
      gap = 8 * next.width + kLeast * next.v;
    }
    // Beside a pole the error can be larger than at the pole.
    constexpr int more_for_smooth = 7;
    const int next_depth = depth + (order < smooth ? 1 : more_for_smooth);
    look(a, bracket.low - gap, next_depth);
    look(bracket.high + gap, b, next_depth);
  }

  std::vector<Break> found;

 private:
  struct Bracket {
    Interval interval;
    double order;  // of the error in its width; infinity where it has none
  };

  // Follows the part with the largest error; where f is not finite that counts as largest. Where f
  // is smooth the error falls like width^8 in the end, at a break like width^order, and rounding
  // or waves too short for doubles show in every part alike. No part ends at the midpoint, where
  // marks lie.
  [[nodiscard]] Bracket narrow(const Interval& all, double rounding) const {
    constexpr int unresolvable = 5;
    constexpr double none = kInfinity, narrow_enough = 1e-4;
    std::vector<Interval> past{all};
    for (int alike = 0; past.back().divides() && !(past.back().error <= rounding);) {
      const Interval now = past.back();
      rounding = std::max(rounding, now.rounding());
      const std::array parts{Interval(f_, now.low, now.at(0.4)),
                             Interval(f_, now.at(0.2), now.at(0.7)),
                             Interval(f_, now.at(0.4), now.high)};
      const auto [least, most] =
          std::minmax_element(parts.begin(), parts.end(), [](const Interval& p, const Interval& q) {
            return p.size() < q.size();
          });
      alike = least->error > 0.1 * now.error ? alike + 1 : 0;
      if (alike == unresolvable) return {all, none};
      past.push_back(*most);
    }
    const Interval& last = past.back();
    if (past.size() <= kSteps || !(last.width() < narrow_enough * last.high)) return {last, none};
    if (std::isnan(last.error)) return {last, 0};
    const Interval& before = past[past.size() - 1 - kSteps];
    return {last, std::log(before.error / last.error) / std::log(before.width() / last.width())};
  }

  // Whether it is a step of rounding, as those of 1 + tanh(v) at v = -17.
  [[nodiscard]] bool rounded(const Break& jump, double error) const {
    constexpr double rounding = 1e-14, width_of_jump = 1e-12;
    return jump.width < width_of_jump * jump.v && error < rounding * largest_ &&
           !std::binary_search(marks_.begin(), marks_.end(), jump.v);
  }

  // A jump is bisected to the precision of v. Next to a root or a pole rounding looks like more.
  [[nodiscard]] Break place(const Interval& bracket, double order, double size) const {
    constexpr double precision = 1e-15, blurred = 2e-7;
    double low = bracket.low, high = bracket.high;
    for (double v = bracket.at(0.5); low < v && v < high; v = low + (high - low) / 2) {
      (std::abs(f_(v) - f_(low)) > std::abs(f_(high) - f_(v)) ? high : low) = v;
    }
    const bool jumps = std::abs(f_(high) - f_(low)) > 0.1 * bracket.error;
    const double v = jumps ? high : bracket.at(0.5), near = jumps ? precision * v : bracket.width();
    const auto mark = std::lower_bound(marks_.begin(), marks_.end(), v - 2 * near);
    const bool exact = mark != marks_.end() && *mark <= v + 2 * near;
    const double most = std::max(std::abs(f_(bracket.low)), std::abs(f_(bracket.high)));
    return {exact ? *mark : v, std::max(near, jumps ? 0 : blurred * v),
            std::isnan(bracket.error) || !(most < 30 * size), order};
  }

  const FunctionOfSpeed& f_;
  const std::vector<double>& marks_;
  double largest_;  // value of f
};

// Ends of windows such as abs(v - 0.5) < 0.01, places where floor(3*v) jumps.
std::vector<double> marks_of(const std::vector<double>& numbers, double reach) {
  std::vector<double> all = numbers;
  for (double a : numbers) {
    for (double b : numbers) all.insert(all.end(), {std::abs(a - b), a + b, a * b, a / b});
  }
  std::erase_if(all, [reach](double mark) { return !(mark > kSlowest * reach && mark <= reach); });
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

bool Break::same_as(const Break& other) const {
  return std::abs(v - other.v) <= 4 * (width + other.width);
}

// By the barycentric formula. The middle, where marks lie, is not among the places.
double interpolation_error(const FunctionOfSpeed& f, double a, double b) {
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
  for (int m : {0, 1, 2, 3, 5, 6, 7, 8}) {
    const double place = std::cos(m * std::numbers::pi / count);
    double sum = 0, weights = 0;
    for (int n = 0; n < count; ++n) {
      sum += weight[n] / (place - node[n]) * at_node[n];
      weights += weight[n] / (place - node[n]);
    }
    const double error = std::abs(sum / weights - value(place));
    if (!std::isfinite(error)) return std::numeric_limits<double>::quiet_NaN();
    largest = std::max(largest, error);
  }
  return largest;
}

void merge(std::vector<Break>& found, const std::vector<Break>& more) {
  for (const Break& next : more) {
    const auto known = std::find_if(found.begin(), found.end(),
                                    [&next](const Break& b) { return b.same_as(next); });
    if (known == found.end()) {
      found.push_back(next);
    } else {
      known->unbounded = known->unbounded || next.unbounded;
      if (next.width < 0.5 * known->width) known->v = next.v, known->width = next.width;
    }
  }
  std::sort(found.begin(), found.end(), [](const Break& a, const Break& b) { return a.v < b.v; });
}

// Intervals are shorter where v is small, and end at no round numbers: a break at an end of two of
// them is in neither.
std::vector<Break> breaks(const FunctionOfSpeed& f, const std::vector<double>& numbers,
                          double reach) {
  constexpr int first = 10, count = 400;
  const auto end = [&](int n) {
    return std::min(reach, reach * std::pow((n + 1 / std::numbers::pi) / count, 3));
  };
  double largest = 0;
  for (int n = first; n <= count; ++n) {
    const double value = std::abs(f(end(n)));
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  const auto marks = marks_of(numbers, reach);
  Search search(f, marks, largest);
  for (double mark : marks) {
    for (double part : {1e-8, 1e-6, 1e-3}) {
      search.look(mark * (1 - part), std::min(reach, mark * (1 + part)));
    }
  }
  for (int n = first; n < count; ++n) search.look(end(n), end(n + 1));
  return search.found;
}

std::vector<double> numbers_in(const std::string& formula) {
  static const std::regex number(R"((\b\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)");
  std::vector<double> numbers;
  for (std::sregex_iterator next(formula.begin(), formula.end(), number), end; next != end;
       ++next) {
    numbers.push_back(std::strtod(next->str().c_str(), nullptr));
  }
  return numbers;
}

}  // namespace stickslip::model
