#include "stickslip/model/observable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

Observable from_expression(const std::string& text, const Friction& friction) {
  const Expression f(text, {"x", "y", "v"}, {{"mu_s", friction.mu_s}, {"mu_d", friction.mu_d}});
  require_finite(f, friction);
  return {text, [f](double x, double y, double v) {
            const double value = f({x, y, v});
            if (std::isfinite(value)) return value;
            throw Failure(ExitStatus::bad_input, not_finite(f.text(), value, x, y, v));
          }};
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

}  // namespace stickslip::model
