#include "stickslip/model/observable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include "stickslip/base/errors.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::model {
namespace {

struct Base {
  const char* name;
  int Unit::*power;
};
// In the order in which they are written.
constexpr std::array kBases{Base{"force", &Unit::force}, Base{"velocity", &Unit::velocity},
                            Base{"time", &Unit::time}};

[[noreturn]] void refuse(std::string_view text) {
  throw std::invalid_argument("no unit: " + std::string(text));
}

// "velocity^2*time"; "1" stands for no factor.
Unit product(std::string_view text) {
  Unit unit;
  if (text == "1") return unit;
  for (const std::string& factor : split(text, '*')) {
    const auto parts = split(factor, '^');
    bool known = false;
    for (const Base& base : kBases) {
      if (parts.at(0) != base.name) continue;
      known = true;
      unit.*base.power += parts.size() == 2 ? std::stoi(parts[1]) : 1;
    }
    if (!known) refuse(text);
  }
  return unit;
}

struct Product {
  std::string text;
  int factors = 0;

  void multiply(const char* name, int power) {
    text += (factors == 0 ? "" : "*") + std::string(name);
    if (power > 1) text += "^" + std::to_string(power);
    ++factors;
  }
};

}  // namespace

Unit Unit::parse(std::string_view text) {
  const auto slash = text.find('/');
  const Unit above = product(text.substr(0, slash));
  if (slash == text.npos) return above;
  std::string_view below = text.substr(slash + 1);
  const bool bracketed = below.size() > 2 && below.front() == '(' && below.back() == ')';
  if (bracketed) below = below.substr(1, below.size() - 2);
  const Unit divisor = product(below);
  if (divisor == Unit{}) refuse(text);
  return above / divisor;
}

std::string Unit::text() const {
  Product above, below;
  for (const Base& base : kBases) {
    const int power = this->*base.power;
    if (power > 0) above.multiply(base.name, power);
    if (power < 0) below.multiply(base.name, -power);
  }
  if (below.factors == 0) return above.text;
  return (above.factors == 0 ? "1" : above.text) + "/" +
         (below.factors == 1 ? below.text : "(" + below.text + ")");
}

namespace {

using Function = Observable::Function;

std::string not_finite(const std::string& text, double value, const Place& x, double y, double v) {
  const auto position = x.position() == 0 ? "" : fmt::format(", p = {:g}", x.position());
  return fmt::format(
      "{} is {} at x = {:g}, y = {:g}, v = {:g}{}; it must be finite in every state, "
      "with y = 0 and v = 0 at rest",
      text, value, x.x, y, v, position);
}

// Tried at rest, as motion starts and in slow motion, where every process has states like these.
void require_finite(const std::string& text, const Function& f, const Friction& friction) {
  const double some_x = friction.mu_s / 2, some_v = 1e-3 * friction.mu_s;
  for (double x : {0.0, some_x, -some_x}) {
    for (double y : {0.0, 1.0, -1.0}) {
      for (double v : {0.0, y * some_v}) {
        const double value = f(x, y, v);
        if (std::isfinite(value)) continue;
        throw std::invalid_argument(not_finite(text, value, x, y, v));
      }
    }
  }
}

Observable from_expression(const std::string& text, const Friction& friction, bool on_spring) {
  std::vector<std::string> variables{"x", "y", "v", "stick", "slide"};
  if (on_spring) variables.emplace_back("p");
  const auto formula = std::make_shared<const Expression>(
      text, variables, Expression::Constants{{"mu_s", friction.mu_s}, {"mu_d", friction.mu_d}});
  const auto f = [formula, on_spring](const Place& x, double y, double v) {
    std::vector<double> values{x.x, y, v, y == 0 ? 1.0 : 0.0, y == 0 ? 0.0 : 1.0};
    if (on_spring) values.push_back(x.position());
    return (*formula)(values);
  };
  require_finite(text, f, friction);
  auto numbers = formula->numbers();
  numbers.insert(numbers.end(), {friction.mu_s, friction.mu_d});
  return {text,
          [f, text](const Place& x, double y, double v) {
            const double value = f(x, y, v);
            if (std::isfinite(value)) return value;
            throw Failure(ExitStatus::bad_input, not_finite(text, value, x, y, v));
          },
          formula,
          numbers,
          false,
          on_spring};
}

bool within(double x, double threshold) {
  return std::abs(x) < threshold || snapped_difference(std::abs(x), threshold) == 0;
}

}  // namespace

const std::vector<std::string>& observable_names() {
  static const std::vector<std::string> names{"1",   "x",     "v",     "v^2",
                                              "|v|", "stick", "slide", "|x|<=mu_s"};
  return names;
}

Observable parse_observable(const std::string& text, const Friction& friction, bool on_spring) {
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
  if (found != named.end()) return {text, found->second, {}, {}, true};
  return from_expression(text, friction, on_spring);
}

FunctionOfSpeed section(std::shared_ptr<const Observable> f, const Place& x, double sign) {
  return [f = std::move(f), x, sign](double speed) {
    try {
      return (*f)(x, sign, sign * speed);
    } catch (const Failure&) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  };
}

namespace {

/// Looks at an observable on levels of the noise.
class Examination {
 public:
  Examination(const Observable& f, double reach)
      : f_(std::make_shared<const Observable>(f)), reach_(reach) {}

  /// The breaks on a level with sign v = sign.
  std::vector<Break> look(const Place& x, double sign) {
    Shape shape;
    std::vector<double> state{x.x, sign, 0, 0, 1};
    if (f_->on_spring) state.push_back(x.position());
    if (f_->formula) shape = shape_of(*f_->formula, state, 2, sign, reach_);
    if (!shape.resolved) refuse(fmt::format("changes too often to be resolved (x = {:g})", x.x));
    auto speeds = shape.places;
    for (int n = 0; n < 40; ++n) speeds.push_back(reach_ * std::pow(0.7, n));
    const auto of_speed = section(f_, x, sign);
    for (double speed : speeds) {
      const double value = of_speed(speed);
      least = std::min(least, value);  // not where it is not a number
      most = std::max(most, value);
    }
    for (const Break& b : shape.breaks) {
      if (b.kind != Break::Kind::pole) continue;
      refuse(fmt::format("is unbounded at v = {:.9g} (x = {:g})", sign * b.v, x.x));
    }
    merge(places, shape.places);
    return shape.breaks;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw std::invalid_argument(f_->name + " " + why);
  }

  double least = kInfinity, most = -kInfinity;
  std::vector<double> places;

 private:
  std::shared_ptr<const Observable> f_;
  double reach_;
};

// Up to 17 levels evenly, and those next to the numbers of f.
std::vector<Place> probed_levels(const Scene& scene, const Observable& f) {
  const auto noise = scene.meant().noise;
  const double seen = std::min(noise.place(largest_force(scene) + scene.friction.mu_d), 1e9);
  const int highest = std::min(noise.highest(), static_cast<int>(seen)),
            lowest = std::max(noise.lowest(), static_cast<int>(-seen));
  constexpr int count = 8;
  std::set<int> levels;
  for (int n = -count; n <= count; ++n) {
    levels.insert(static_cast<int>((n > 0 ? highest : -lowest) * (n * 1.0 / count)));
  }
  for (double number : f.numbers) {
    for (double x : {number, -number}) {
      const double near = std::clamp<double>(noise.place(x), lowest, highest);
      levels.insert({static_cast<int>(std::floor(near)), static_cast<int>(std::ceil(near))});
    }
  }
  std::vector<Place> x;
  for (int level : levels) x.push_back(noise.place_of(level));
  std::sort(x.begin(), x.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  return x;
}

}  // namespace

Observable friction_power(const Friction& friction) {
  return {"friction_power",
          [along = friction, backwards = friction.mirrored()](double, double, double v) {
            return v > 0 ? along(v) * v : -backwards(-v) * v;
          },
          {},
          {},
          !friction.weakens()};
}

void examine(Observable& f, const std::vector<Place>& x, double step, double reach) {
  Examination examination(f, reach);
  constexpr std::array signs{1.0, -1.0};
  constexpr std::size_t too_many = 65;
  const auto [lowest, highest] = std::ranges::minmax(x);
  std::vector<Break> found;
  for (const Place& level : x) {
    for (double sign : signs) merge(found, examination.look(level, sign));
    if (found.size() < too_many) continue;
    examination.refuse(fmt::format("has {} or more jumps and kinks in v", too_many));
  }
  for (const Place& level : x) {
    Place next = level;
    next.x += level > 0 ? -step : step;
    next.p *= 0.93;                                 // what moves with the position moves here
    if (next < lowest || next > highest) continue;  // the noise does not get there
    for (double sign : signs) {
      for (const Break& b : examination.look(next, sign)) {
        const auto same = [&b](const Break& other) { return b.same_as(other); };
        if (std::any_of(found.begin(), found.end(), same)) continue;
        examination.refuse(fmt::format(
            "jumps or has a kink at v = {:.9g} where x = {:g}, and elsewhere for other x",
            sign * b.v, next.x));
      }
    }
  }
  f.levels = x;
  f.breaks.clear();
  for (const Break& b : found) f.breaks.push_back(b.v);
  f.places = examination.places;
  f.least = examination.least;
  f.most = examination.most;
  for (const Place& level : x) {
    f.least = std::min(f.least, f(level, 0, 0));
    f.most = std::max(f.most, f(level, 0, 0));
  }
}

void examine(Observable& f, const Scene& scene, double reach) {
  examine(f, probed_levels(scene, f), scene.meant().noise.step(), reach);
}

}  // namespace stickslip::model
