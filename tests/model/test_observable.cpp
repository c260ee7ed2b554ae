#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/model/process.hpp"

using stickslip::model::Friction;
using stickslip::model::Observable;
using stickslip::model::observable_names;
using stickslip::model::parse_observable;

namespace {

const Friction kFriction{0.3, 0.2};

double at(const char* text, double x, double y, double v) {
  return parse_observable(text, kFriction)(x, y, v);
}

}  // namespace

TEST_CASE("observables: names") {
  CHECK(at("1", 2, 1, 3) == 1);
  CHECK(at("x", 2, 1, 3) == 2);
  CHECK(at("v", 2, 1, 3) == 3);
  CHECK(at("v^2", 2, 1, -3) == 9);
  CHECK(at("|v|", 2, -1, -3) == 3);
  CHECK(at("stick", 0, 0, 0) == 1);
  CHECK(at("stick", 0, 1, 0) == 0);
  CHECK(at("slide", 0, 0, 0) == 0);
  CHECK(at("slide", 0, -1, -1) == 1);
  CHECK(at("|x|<=mu_s", -3 * 0.1, 1, 0) == 1);  // 0.30000000000000004
  CHECK(at("|x|<=mu_s", 0.300001, 1, 0) == 0);
  CHECK(at("|x|<=mu_s", -0.300001, 1, 0) == 0);
  for (const auto& name : observable_names()) CHECK_NOTHROW(parse_observable(name, kFriction));
}

TEST_CASE("observables: expressions") {
  CHECK(at("x*v", 2, 1, 3) == 6);
  CHECK(at("y == 0 ? x^2 : -1", 3, 0, 0) == 9);
  CHECK(at("y == 0 ? x^2 : -1", 3, 1, 0) == -1);
  CHECK(at("mu_s - mu_d", 0, 0, 0) == Approx(0.1));
  CHECK(at("max(abs(v), 2)", 0, 1, -5) == 5);
}

TEST_CASE("observables: even and odd parts add up") {
  const auto f = parse_observable("x + v^2 + y*x*v", kFriction);
  const double x = 0.7, y = 1, v = 1.3;
  CHECK(f.even(x, y, v) + f.odd(x, y, v) == Approx(f(x, y, v)));
  CHECK(f.even(x, y, v) == f.even(-x, -y, -v));
  CHECK(f.odd(x, y, v) == -f.odd(-x, -y, -v));
}

TEST_CASE("observables: what cannot be read is refused") {
  for (const char* bad : {"", "x+", "q", "sin(", "x v", "|x|"}) {
    INFO(bad);
    CHECK_THROWS_AS(parse_observable(bad, kFriction), std::invalid_argument);
  }
}

namespace {

std::string refusal(const char* text) {
  try {
    (void)parse_observable(text, kFriction);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

// muParser gives the last of several expressions, and assigns to its variables.
TEST_CASE("observables: one expression, and no assignment") {
  for (const char* several : {"v,x", "x*v, 1", "(v,x)"}) {
    INFO(several);
    CHECK_THROWS_AS(parse_observable(several, kFriction), std::invalid_argument);
  }
  CHECK_THAT(refusal("v,x"), Catch::Contains("more than one expression"));
  for (const char* assignment : {"x=3", "x = 3", "v=x", "y == 0 ? (x=3) : 1", "1 + (x=2)"}) {
    INFO(assignment);
    CHECK_THAT(refusal(assignment), Catch::Contains("assigns"));
  }
  for (const char* comparison : {"x==3", "x<=3", "x >= 3", "x!=3", "max(x, v) == min(x, v)"}) {
    INFO(comparison);
    CHECK(refusal(comparison) == "none");
  }
}

TEST_CASE("observables: not finite somewhere, and the message names the place") {
  CHECK_THAT(refusal("1/v"), Catch::Contains("1/v is inf at x = 0, y = 0, v = 0"));
  CHECK_THAT(refusal("log(x)"), Catch::Contains("at x = 0, y = 0, v = 0"));
  CHECK_THAT(refusal("sqrt(x)"), Catch::Contains("at x = -0.15, y = 0, v = 0"));
  CHECK_THAT(refusal("sqrt(v)"), Catch::Contains("at x = 0, y = -1, v = -0.0003"));
  CHECK_THAT(refusal("y == 0 ? 0 : 1/v"), Catch::Contains("at x = 0, y = 1, v = 0"));
  CHECK_THAT(refusal("y == 1 ? log(x) : 1"), Catch::Contains("y = 1"));
  CHECK(refusal("y == 0 ? 0 : 1/(abs(v) + 1)") == "none");
  CHECK(refusal("sqrt(abs(x)) + log(1 + v^2)") == "none");

  const auto pole = parse_observable("1/(abs(x) - 2)", kFriction);
  CHECK(pole(1, 1, 0.5) == -1);
  try {
    (void)pole(-2, 1, 0.5);
    FAIL("a value at the pole");
  } catch (const stickslip::Failure& failure) {
    CHECK(failure.status() == stickslip::ExitStatus::bad_input);
    CHECK_THAT(failure.what(), Catch::Contains("inf at x = -2, y = 1, v = 0.5"));
  }
}

namespace {

// On the levels k/4, |k| <= 8, and those between.
Observable examined(const std::string& text, double reach = 20) {
  auto f = parse_observable(text, kFriction);
  std::vector<stickslip::model::Place> x;
  for (int i = -8; i <= 8; ++i) x.push_back(i * 0.25);
  examine(f, x, 0.125, reach);
  return f;
}

std::string reason(const std::string& text) {
  try {
    (void)examined(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

using Speeds = std::vector<double>;

}  // namespace

TEST_CASE("observables: their breaks in v, on either side and whatever the level") {
  CHECK(examined("abs(v) > 0.5").breaks == Speeds{0.5});
  CHECK(examined("v < -12 ? x : 0").breaks == Speeds{12});
  CHECK(examined("v > mu_s + mu_d").breaks == Speeds{0.5});
  CHECK(examined("min(v, 1) + max(v, -2)").breaks == Speeds{1, 2});
  CHECK(examined("(x == 2)*(v > 4)").breaks == Speeds{4});
  CHECK(examined("(x > 1) ? abs(v) > 3 : v > 4").breaks == Speeds{3, 4});
  CHECK(examined("abs(abs(v) - 0.5) < 0.01").breaks == Speeds{0.49, 0.51});
  CHECK(examined("rint(v)", 3).breaks.size() == 3);
  CHECK(examined("v > 5", 4).breaks.empty());
}

TEST_CASE("observables: what is smooth, jumps at v = 0 or in x has no breaks in v") {
  for (const char* text : {"tanh(50*v)", "tanh(1e6*(v-0.5))", "abs(v)", "v >= 0 ? 2 : -1",
                           "sign(v)*v^2", "x > 0.5", "(x>0.5)*v", "y*x*v", "y == 0 ? v > 0.5 : v",
                           "abs(x - 0.5)*v", "exp(-1000*(v-3)^2)", "1e20*v^3", "1e-20*v"}) {
    INFO(text);
    CHECK(examined(text).breaks.empty());
  }
  for (const auto& name : observable_names()) {
    INFO(name);
    CHECK(examined(name).breaks.empty());
  }
}

TEST_CASE("observables: breaks at which no element can end are refused, with the place") {
  CHECK_THAT(reason("v > x"), Catch::Contains("at v = ") && Catch::Contains("for other x"));
  CHECK_THAT(reason("abs(v - x)"), Catch::Contains("for other x"));
  CHECK_THAT(reason("abs(v) < 1e-4 + abs(x)"), Catch::Contains("for other x"));
  CHECK_THAT(reason("1/(v - 0.7310585)"), Catch::Contains("unbounded at v = 0.7310585"));
  CHECK_THAT(reason("1/(abs(v) + x - 5)"), Catch::Contains("unbounded"));
  CHECK_THAT(reason("rint(10*v)"), Catch::Contains("65 or more"));
  CHECK(reason("log(abs(abs(v) - 0.7310585))") == "none");
}

TEST_CASE("observables: the values seen show what is a probability") {
  for (const char* text : {"abs(v) > 0.5", "stick", "1", "x > 0 && v < 3", "exp(-v^2)"}) {
    INFO(text);
    CHECK(examined(text).within_unit());
  }
  // On one level only, at rest only, in a narrow window only.
  for (const char* text : {"v", "x == 2 ? -1 : 1", "y == 0 ? 2 : 0", "1 + (abs(v-3) < 1e-4)"}) {
    INFO(text);
    CHECK_FALSE(examined(text).within_unit());
  }
  CHECK_FALSE(parse_observable("stick", kFriction).within_unit());
}

TEST_CASE("observables: a section goes along |v|, with the signs of y and v") {
  const auto f = std::make_shared<const Observable>(
      parse_observable("y*v + x + (abs(v) == 3 ? log(-1) : 0)", kFriction));
  CHECK(stickslip::model::section(f, 2, -1)(5) == 7);
  CHECK(stickslip::model::section(f, 2, 1)(5) == 7);
  CHECK(std::isnan(stickslip::model::section(f, 2, 1)(3)));
}

TEST_CASE("observables: a scene shows them on its outermost levels and on those next to numbers") {
  stickslip::model::Scene scene;
  scene.delta = 0.25;
  scene.friction = kFriction;
  scene.noise_levels = 40;
  auto f = parse_observable("abs(x) > 1.1", kFriction);
  examine(f, scene, 20);
  for (double x : {10.0, -10.0, 1.25, -1.25, 1.0, -1.0, 0.0}) {
    INFO(x);
    CHECK(std::count(f.levels.begin(), f.levels.end(), x) == 1);
  }
  for (double x : f.levels) {
    CHECK(std::abs(x) <= 10);
    CHECK(std::remainder(x, scene.delta) == 0);
  }
  CHECK(f.within_unit());
}
