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
