#include "stickslip/model/observable.hpp"

#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>

#include "stickslip/model/grid_index.hpp"

namespace stickslip::model {
namespace {

using Function = std::function<double(double, double, double)>;

// The variables live beside the parser, which keeps their addresses. muParser: small, maintained,
// packaged, compiles to bytecode.
struct Expression {
  explicit Expression(const std::string& text, const Friction& friction) {
    parser.DefineVar("x", &x);
    parser.DefineVar("y", &y);
    parser.DefineVar("v", &v);
    parser.DefineConst("mu_s", friction.mu_s);
    parser.DefineConst("mu_d", friction.mu_d);
    parser.SetExpr(text);
  }
  double operator()(double x_value, double y_value, double v_value) {
    x = x_value;
    y = y_value;
    v = v_value;
    return parser.Eval();
  }

  double x = 0, y = 0, v = 0;
  mu::Parser parser;
};

Observable from_expression(const std::string& text, const Friction& friction) {
  try {
    const auto expression = std::make_shared<Expression>(text, friction);
    (void)(*expression)(0.5, 1, 0.25);  // the parser reads the text at its first use
    return {text, [expression](double x, double y, double v) { return (*expression)(x, y, v); }};
  } catch (const mu::ParserError& error) {
    throw std::invalid_argument(error.GetMsg());
  }
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
