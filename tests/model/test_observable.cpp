#include <catch2/catch.hpp>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include "stickslip/model/observable.hpp"
#include "stickslip/support/errors.hpp"

using stickslip::model::Friction;
using stickslip::model::Jump;
using stickslip::model::observable_names;
using stickslip::model::parse_observable;
using stickslip::model::velocity_jump;

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

TEST_CASE("observables: what cannot be read is told") {
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

TEST_CASE("observables: not finite somewhere, and where is told") {
  CHECK_THAT(refusal("1/v"), Catch::Contains("1/v is inf at x = 0, y = 0, v = 0"));
  CHECK_THAT(refusal("log(x)"), Catch::Contains("at x = 0, y = 0, v = 0"));
  CHECK_THAT(refusal("sqrt(x)"), Catch::Contains("at x = -0.15, y = 0, v = 0"));
  CHECK_THAT(refusal("sqrt(v)"), Catch::Contains("at x = 0, y = -1, v = -0.001"));
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

std::optional<Jump> jump_of(const std::string& text, double reach = 20) {
  std::vector<double> x;
  for (int i = -8; i <= 8; ++i) x.push_back(i * 0.25);
  return velocity_jump(parse_observable(text, kFriction), x, reach);
}

struct Jumping {
  const char* text;
  double speed;
};

}  // namespace

TEST_CASE("observables: jumps in v are found to the precision of v") {
  const std::vector<Jumping> all{{"abs(v)>0.5", 0.5},
                                 {"v >= 0.5", 0.5},
                                 {"abs(v) < 3.7 ? 1 : 1.1", 3.7},
                                 {"v < -12 ? x : 0", 12},
                                 {"sign(v - 0.731)", 0.731},
                                 {"v^4 + 0.1*(v > 1.5)", 1.5},
                                 {"v - 0.01*(v > 2)", 2},
                                 {"rint(v)", 0.5},
                                 {"v^2 > 2", std::sqrt(2.0)},
                                 {"1/(v - 0.7310585)", 0.7310585},
                                 {"(x == 2) * (v > 4)", 4},
                                 {"v > mu_s + mu_d", 0.5},
                                 {"atan2(v - 0.5, -1)", 0.5}};
  for (const auto& [text, speed] : all) {
    INFO(text);
    const auto jump = jump_of(text);
    REQUIRE(jump);
    CHECK(std::abs(jump->v) == Approx(speed).epsilon(1e-14));
    CHECK(jump->y == (jump->v > 0 ? 1 : -1));
  }
}

TEST_CASE("observables: narrow windows in v are jumps") {
  for (const char* text :
       {"(v>0.5)*(v<0.51)", "(v>0.5)*(v<0.5000001)", "abs(v - 11.1) < 1e-6",
        "abs(abs(v) - mu_s) < 1e-5", "abs(v-x)<1e-4", "(v>17.3333)&&(v<17.3334)"}) {
    INFO(text);
    CHECK(jump_of(text));
  }
}

TEST_CASE("observables: a jump at a velocity that depends on x") {
  const auto jump = jump_of("v > x");
  REQUIRE(jump);
  CHECK(jump->v == Approx(jump->x).epsilon(1e-14));
}

TEST_CASE("observables: what is steep, bent or jumps at v = 0 or in x does not jump in v") {
  for (const char* text : {"tanh(50*v)",
                           "tanh(1e6*(v-0.5))",
                           "abs(v)",
                           "min(v,1)",
                           "max(0,abs(v)-1.3)^2",
                           "v>0",
                           "v >= 0 ? 2 : -1",
                           "sign(v)*v^2",
                           "x > 0.5",
                           "(x>0.5)*v",
                           "y*x*v",
                           "y == 0 ? v > 0.5 : v",
                           "sqrt(abs(v-0.5))",
                           "abs(v-0.5)^(1/3)",
                           "exp(-1000*(v-3)^2)",
                           "sin(300*v)",
                           "v^9",
                           "exp(v)",
                           "log(1+v^2)",
                           "1e-20*v",
                           "1e20*v^3",
                           "1",
                           "abs(v - x)",
                           "abs(v)/(1+abs(v))"}) {
    INFO(text);
    CHECK_FALSE(jump_of(text));
  }
  for (const auto& name : observable_names()) {
    INFO(name);
    CHECK_FALSE(jump_of(name));
  }
}

TEST_CASE("observables: a jump out of reach does not count") {
  CHECK_FALSE(jump_of("v > 5", 4));
  CHECK(jump_of("v > 5", 6));
}
