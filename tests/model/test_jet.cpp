#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/model/expression.hpp"

using stickslip::model::Expression;
using stickslip::model::Interval;
using stickslip::model::Jet;
using stickslip::model::kJetOrder;

namespace {

Jet jet(const std::string& text, double low, double high) {
  return Expression(text, {"v"}, {}).jet({Jet({low, high}, 1)});
}

bool holds(const Interval& a, double x) { return a.low <= x && x <= a.high; }

const std::vector<std::string> kSmooth{"v^3 - 2*v",
                                       "exp(-v^2)",
                                       "sin(3*v)/v",
                                       "cos(v)*tanh(v)",
                                       "log(v)/v^2",
                                       "sqrt(v)",
                                       "v^-1.5",
                                       "atan(5*v - 4)",
                                       "tan(v/3)",
                                       "asin(v/4)",
                                       "acos(v/4)",
                                       "sinh(v)",
                                       "cosh(v - 1)",
                                       "asinh(2*v)",
                                       "acosh(v + 2)",
                                       "atanh(v/4)",
                                       "2^v",
                                       "v^v",
                                       "atan2(v, 1)",
                                       "atan2(1, -v)",
                                       "1/(1 + exp(-v))",
                                       "tanh(100*v)",
                                       "exp(-(40*(v - 1.3))^2)"};

}  // namespace

TEST_CASE("jets: hold the values of formulas, and the polynomial and remainder of Taylor") {
  for (const auto& text : kSmooth) {
    const Expression f(text, {"v"}, {});
    for (double width : {1e-3, 0.05, 0.8}) {
      for (double low : {0.5, 1.2, 2.0}) {
        const Jet all = jet(text, low, low + width), at_low = jet(text, low, low);
        INFO(text << " from " << low << " by " << width);
        REQUIRE_FALSE(all.rough);
        for (double part : {0.1, 0.5, 1.0}) {
          const double h = part * width;
          CHECK(holds(all.at[0], f({low + h})));
          double sum = 0, doubt = 1e-13 * (1 + std::abs(f({low})));
          for (std::size_t k = 0; k < kJetOrder; ++k) {
            sum += (at_low.at[k].low + at_low.at[k].high) / 2 * std::pow(h, k);
            doubt += (at_low.at[k].high - at_low.at[k].low) * std::pow(h, k);
          }
          const double rest = f({low + h}) - sum, power = std::pow(h, kJetOrder);
          const Interval bound{all.at[kJetOrder].low * power - doubt,
                               all.at[kJetOrder].high * power + doubt};
          CHECK(holds(bound, rest));
        }
      }
    }
  }
}

TEST_CASE("jets: coefficients of a series by hand") {
  const Jet exponential = jet("exp(v)", 0, 0), sine = jet("sin(v)", 0, 0),
            tangent = jet("tan(v)", 0, 0);
  double factorial = 1;
  for (std::size_t k = 0; k <= kJetOrder; factorial *= static_cast<double>(++k)) {
    CHECK(exponential.at[k].low == Approx(1 / factorial).epsilon(1e-13));
    const double of_sine = k % 2 == 0 ? 0 : (k % 4 == 1 ? 1 : -1) / factorial;
    CHECK(sine.at[k].high == Approx(of_sine).margin(1e-15));
  }
  for (const auto& [k, value] : std::vector<std::pair<std::size_t, double>>{
           {1, 1}, {3, 1 / 3.0}, {5, 2 / 15.0}, {7, 17 / 315.0}, {6, 0}}) {
    CHECK(tangent.at[k].low == Approx(value).margin(1e-14));
  }
}

TEST_CASE("jets: rough where there may be a break, and there alone") {
  for (const char* text :
       {"abs(v - 1)", "max(v, 1)", "sign(v - 1)", "rint(v - 0.5)", "v > 1", "v == 1 ? 2 : 3",
        "1/(v - 1)", "sqrt(v - 1)", "log(v - 1)", "(v - 1)^1.5", "asin(v)", "acosh(v)", "atanh(v)",
        "tan(v*_pi/2)", "v > 1 && v < 2"}) {
    INFO(text);
    CHECK(jet(text, 0.9, 1.1).rough);
  }
  for (const char* text : {"abs(v - 1)", "max(v, 1)", "sign(v - 1)", "v > 1", "0*abs(v - 1.05)",
                           "v < 0 ? abs(v - 1.05) : v", "min(2, max(v, -1))"}) {
    INFO(text);
    CHECK_FALSE(jet(text, 1.0001, 1.1).rough);
  }
}
