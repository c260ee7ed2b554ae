#include "stickslip/model/observable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <stdexcept>

#include "stickslip/model/expression.hpp"
#include "stickslip/model/grid_index.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::model {
namespace {

using Function = std::function<double(double, double, double)>;

std::string not_finite(const std::string& text, double value, double x, double y, double v) {
  return fmt::format("{} is {} at x = {:g}, y = {:g}, v = {:g}; it must be finite in every state, "
                     "with y = 0 and v = 0 at rest",
                     text, value, x, y, v);
}

// Tried at rest, as motion starts and in slow motion, where every scene has states like these.
void require_finite(const Expression& f, const Friction& friction) {
  const double some_x = friction.mu_s / 2, some_v = 1e-3;
  for (double x : {0.0, some_x, -some_x}) {
    for (double y : {0.0, 1.0, -1.0}) {
      for (double v : {0.0, y * some_v}) {
        const double value = f({x, y, v});
        if (std::isfinite(value)) continue;
        throw std::invalid_argument(not_finite(f.text(), value, x, y, v));
      }
    }
  }
}

// Those in an expression, digits of names such as log10 left out.
std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  const auto letter = [&](std::size_t n) {
    return std::isalnum(static_cast<unsigned char>(text[n])) != 0 || text[n] == '_';
  };
  for (std::size_t n = 0; n < text.size();) {
    const char* begin = text.c_str() + n;
    const bool digit = std::isdigit(static_cast<unsigned char>(text[n])) != 0 || text[n] == '.';
    char* end = nullptr;
    const double value = digit && (n == 0 || !letter(n - 1)) ? std::strtod(begin, &end) : 0;
    if (end != nullptr && end != begin) numbers.push_back(value);
    n += end != nullptr && end != begin ? static_cast<std::size_t>(end - begin) : 1;
  }
  return numbers;
}

Observable from_expression(const std::string& text, const Friction& friction) {
  const Expression f(text, {"x", "y", "v"}, {{"mu_s", friction.mu_s}, {"mu_d", friction.mu_d}});
  require_finite(f, friction);
  auto numbers = numbers_in(text);
  numbers.insert(numbers.end(), {friction.mu_s, friction.mu_d});
  return {text,
          [f](double x, double y, double v) {
            const double value = f({x, y, v});
            if (std::isfinite(value)) return value;
            throw Failure(ExitStatus::bad_input, not_finite(f.text(), value, x, y, v));
          },
          numbers};
}

bool within(double x, double threshold) {
  return std::abs(x) < threshold || snapped_difference(std::abs(x), threshold) == 0;
}

/// v -> f(x, sign v, v); not a number where f is not finite.
struct Section {
  const Observable& f;
  double x, sign;
  [[nodiscard]] double operator()(double speed) const {
    try {
      return f(x, sign, sign * speed);
    } catch (const Failure&) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  }
};

/// A function between two places, seen there and in the middle.
struct Piece {
  double low, high, at_low, at_middle, at_high;

  Piece(const Section& f, double from, double to, double at_from, double at_to)
      : low(from), high(to), at_low(at_from), at_middle(f(middle())), at_high(at_to) {}
  [[nodiscard]] double middle() const { return low + (high - low) / 2; }
  [[nodiscard]] bool splits() const { return low < middle() && middle() < high; }
  /// Distance from a straight line: half of a jump, little where the function is smooth, infinite
  /// at a pole.
  [[nodiscard]] double bend() const {
    const double bend = std::abs(at_middle - (at_low + at_high) / 2);
    return std::isnan(bend) ? std::numeric_limits<double>::infinity() : bend;
  }
  [[nodiscard]] double rise() const { return std::abs(at_high - at_low); }
  [[nodiscard]] double size() const {
    return std::max({std::abs(at_low), std::abs(at_middle), std::abs(at_high)});
  }
  [[nodiscard]] Piece more_bent_half(const Section& f) const {
    const Piece lower(f, low, middle(), at_low, at_middle),
        upper(f, middle(), high, at_middle, at_high);
    return lower.bend() > upper.bend() ? lower : upper;
  }
};

// A bend that no halving makes smaller is a jump, and so is a pole.
std::optional<double> jump_in(const Section& f, Piece piece) {
  if (!std::isfinite(piece.at_low) || !std::isfinite(piece.at_high)) return std::nullopt;
  const double least = std::max(0.1 * piece.bend(), 1e-6 * piece.size());
  if (!(piece.bend() > 0.1 * piece.rise()) || 2 * piece.bend() < least) return std::nullopt;
  for (; piece.splits(); piece = piece.more_bent_half(f)) {
    if (!std::isfinite(piece.at_middle)) return piece.middle();
    if (piece.bend() + piece.rise() < least) return std::nullopt;
  }
  return piece.rise() > least ? std::optional(piece.high) : std::nullopt;
}

// Ends of windows such as abs(v - 0.5) < 0.01 or v > x.
std::vector<double> marks(const Observable& f, double x) {
  std::vector<double> numbers = f.numbers, all{std::abs(x)};
  if (x != 0) numbers.push_back(std::abs(x));
  for (double a : numbers) {
    all.push_back(a);
    for (double b : numbers) all.insert(all.end(), {std::abs(a - b), a + b});
  }
  return all;
}

// Closer together where v is small, and on both sides of each mark.
std::vector<double> probed_speeds(const std::vector<double>& marks, double reach) {
  constexpr int count = 1000;
  std::vector<double> v;
  for (int n = 1; n <= count; ++n) v.push_back(reach * std::pow(n * 1.0 / count, 3));
  for (double mark : marks) {
    for (double side : {1 - 1e-7, 1 - 1e-12, 1 + 1e-12, 1 + 1e-7}) v.push_back(mark * side);
  }
  std::erase_if(v, [reach](double speed) { return speed <= 0 || speed > reach; });
  std::sort(v.begin(), v.end());
  return v;
}

std::optional<double> first_jump(const Section& f, const std::vector<double>& v) {
  double before = f(v.front());
  for (std::size_t n = 1; n < v.size(); ++n) {
    const double after = f(v[n]);
    if (const auto jump = jump_in(f, {f, v[n - 1], v[n], before, after})) return jump;
    before = after;
  }
  return std::nullopt;
}

}  // namespace

const std::vector<std::string>& observable_names() {
  static const std::vector<std::string> names{"1",   "x",     "v",     "v^2",
                                              "|v|", "stick", "slide", "|x|<=mu_s"};
  return names;
}

Observable parse_observable(const std::string& text, const Friction& friction) {
  const double mu_s = friction.mu_s;
  const std::map<std::string, Function> named{
      {"1", [](double, double, double) { return 1.0; }},
      {"x", [](double x, double, double) { return x; }},
      {"v", [](double, double, double v) { return v; }},
      {"v^2", [](double, double, double v) { return v * v; }},
      {"|v|", [](double, double, double v) { return std::abs(v); }},
      {"stick", [](double, double y, double) { return y == 0 ? 1.0 : 0.0; }},
      {"slide", [](double, double y, double) { return y == 0 ? 0.0 : 1.0; }},
      {"|x|<=mu_s", [mu_s](double x, double, double) { return within(x, mu_s) ? 1.0 : 0.0; }}};
  const auto found = named.find(text);
  if (found != named.end()) return {text, found->second};
  return from_expression(text, friction);
}

std::optional<Jump> velocity_jump(const Observable& f, const std::vector<double>& x, double reach) {
  for (double level : x) {
    const auto v = probed_speeds(marks(f, level), reach);
    for (double sign : {1.0, -1.0}) {
      const auto speed = first_jump({f, level, sign}, v);
      if (speed) return Jump{level, sign, sign * *speed};
    }
  }
  return std::nullopt;
}

}  // namespace stickslip::model
