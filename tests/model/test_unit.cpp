#include "../common/catch.hpp"
#include "stickslip/model/observable.hpp"

#include <stdexcept>

using stickslip::model::Unit;

TEST_CASE("unit: a text is read and written alike") {
  for (const char* text : {"", "time", "velocity^2*time^2", "1/time", "1/(velocity*time)",
                           "force*velocity", "force^2/time", "force/(velocity^2*time^3)"}) {
    INFO(text);
    CHECK(Unit::parse(text).text() == text);
  }
  CHECK(Unit::parse("force^2*velocity/time^3") == Unit{2, 1, -3});
  CHECK(Unit::parse("1") == Unit{});
}

TEST_CASE("unit: quotients are fractions at most once") {
  const auto quotient = [](const char* a, const char* b) {
    return (Unit::parse(a) / Unit::parse(b)).text();
  };
  CHECK(quotient("", "1/time") == "time");
  CHECK(quotient("time", "1/time") == "time^2");
  CHECK(quotient("velocity^2", "1/time") == "velocity^2*time");
  CHECK(quotient("time", "time").empty());
  CHECK(quotient("force*velocity", "force") == "velocity");
  CHECK(quotient("velocity", "force") == "velocity/force");
  CHECK(quotient("1/time", "force") == "1/(force*time)");
  CHECK(quotient("", "force") == "1/force");
}

TEST_CASE("unit: what is none is refused") {
  for (const char* text : {"length", "1/(1/time)", "time/", "time/(time", "time^x", "2*time"}) {
    INFO(text);
    CHECK_THROWS_AS(Unit::parse(text), std::invalid_argument);
  }
}
