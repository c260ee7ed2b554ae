#include <catch2/catch.hpp>
#include <stdexcept>

#include "stickslip/model/observable.hpp"

using stickslip::model::Friction;
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
