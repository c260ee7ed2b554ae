#include <cmath>
#include <stdexcept>

#include "../common/catch.hpp"
#include "stickslip/model/expression.hpp"

using stickslip::model::Expression;

TEST_CASE("expressions: variables in their order, constants by name") {
  const Expression f("a*x - y", {"x", "y"}, {{"a", 3}});
  CHECK(f({2, 1}) == 5);
  CHECK(f({-1, 4}) == -7);
  CHECK(f.text() == "a*x - y");
}

TEST_CASE("expressions: a copy outlives what it was copied from") {
  const auto copy = [] {
    const Expression f("x^2", {"x"}, {});
    CHECK(f({3}) == 9);
    return Expression(f);
  }();
  const Expression another(copy);
  CHECK(copy({5}) == 25);
  CHECK(another({-2}) == 4);
}

TEST_CASE("expressions: what is none is refused") {
  for (const char* bad : {"", "x+", "q", "x = 3", "x, 2", "x x"}) {
    INFO(bad);
    CHECK_THROWS_AS(Expression(bad, {"x"}, {}), std::invalid_argument);
  }
}

TEST_CASE("expressions: the grammar and the functions are muParser's") {
  const auto value = [](const char* text, double v = 0.3) {
    return Expression(text, {"v"}, {})({v});
  };
  CHECK(value("-2^2") == -4);
  CHECK(value("2^3^2") == 512);
  CHECK(value("2^-v^2") == std::pow(2, -0.3 * 0.3));
  CHECK(value("-v*2 + +1") == Approx(0.4));
  CHECK(value("8/4/2") == 1);
  CHECK(value("1 < 2 == 1") == 1);
  CHECK(value("v > 0.3 || v >= 0.3 && v <= 0.3") == 1);
  CHECK(value("v != 0.3 ? 1 : v < 0.2 ? 2 : 3") == 3);
  CHECK(value("max(1, v, 7, 2) - min(3, v) + sum(1, 2, 3) + avg(1, 3)") == Approx(14.7));
  CHECK(value("rint(2.5) + rint(-2.5)") == 1);
  CHECK(value("sign(-v) + abs(-v)") == Approx(-0.7));
  CHECK(value("log(v) - ln(v) + log2(8) + log10(1000)") == Approx(6));
  CHECK(value("cot(v)*tan(v) + coth(v)*tanh(v)") == Approx(2));
  CHECK(value("asinh(sinh(v)) + acosh(cosh(v)) + atanh(tanh(v))") == Approx(0.9));
  CHECK(value("asin(sin(v)) + acos(cos(v)) + atan2(sin(v), cos(v)) + atan(tan(v))") == Approx(1.2));
  CHECK(value("exp(v) - sqrt(v) - _e^v + v^0.5") == Approx(0).margin(1e-15));
  CHECK(value("asinh(-1e12)") == Approx(-std::asinh(1e12)));
  for (const char* bad : {"rnd()", "sum()", "sin(1, 2)", "2 3"}) {
    CHECK_THROWS_AS(Expression(bad, {"v"}, {}), std::invalid_argument);
  }
}

TEST_CASE("expressions: odd ones are known by their form") {
  const auto odd = [](const char* text) { return Expression(text, {"v"}, {}).odd(); };
  for (const char* text :
       {"-v", "-v - 0.1*v*abs(v)", "-v^3/(1 + v^2)", "-tanh(v/0.75) - 0.4*v", "max(-1, min(1, -v))",
        "min(1, max(v, -1))", "v > 0 ? -v^2 : v^2", "-v - max(0, v - 0.3) + max(0, -v - 0.3)",
        "abs(v) < 1 ? -v : -v - 5*(v - sign(v))", "-atan(20*(v - 0.5)) - atan(20*(v + 0.5))",
        "-(exp(v) - exp(-v))/2", "0*v", "-sign(v)*(1 - exp(-abs(v)))", "abs(v - 1) - abs(v + 1)",
        "-(v + abs(v))^2 + (v - abs(v))^2", "-(v > 0)*v^2 + (v < 0)*v^2", "-v*sqrt(abs(v))",
        "-sinh(3*v)", "-rint(v)"}) {
    INFO(text);
    CHECK(odd(text));
  }
  for (const char* text : {"v > 0 ? -v : -3*v", "-v - 5*max(v - 2000000, 0)", "1 - exp(v)", "v^2",
                           "-0.5*v - 5*exp(-((v - 0.9)/0.001)^2)", "-v - 1e-9*v^2", "-v + 1",
                           "-v - max(0, v - 0.3) + max(0, -v - 0.31)", "max(-1, min(1.1, -v))",
                           "v > 1 ? -v : -v - 1e-30*v^2", "-v - cos(v)", "abs(v)"}) {
    INFO(text);
    CHECK_FALSE(odd(text));
  }
}
