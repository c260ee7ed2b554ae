#include <algorithm>
#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/model/expression.hpp"

using stickslip::model::Break;
using stickslip::model::Expression;
using stickslip::model::Shape;

namespace {

using Speeds = std::vector<double>;

Shape shape(const std::string& text, double sign = 1, double reach = 20) {
  return shape_of(Expression(text, {"v"}, {}), {0}, 0, sign, reach);
}

Speeds places(const std::string& text, double sign = 1, double reach = 20) {
  Speeds v;
  for (const Break& b : shape(text, sign, reach).breaks) v.push_back(b.v);
  return v;
}

}  // namespace

TEST_CASE("breaks: those at decimal numbers are exact") {
  CHECK(places("abs(v - 0.3)") == Speeds{0.3});
  CHECK(places("min(v, 0.1 + 0.7)") == Speeds{0.8});
  CHECK(places("v > 3*0.7") == Speeds{2.1});
  CHECK(places("max(0, v - 1.3)^2") == Speeds{1.3});
  CHECK(places("sqrt(abs(v - 2))") == Speeds{2});
  CHECK(places("abs(v - 11.1) < 1e-6") == Speeds{11.099999, 11.100001});
  CHECK(places("abs(v + 3)").empty());
  CHECK(places("abs(v + 3)", -1) == Speeds{3});
  CHECK(places("v > 5", 1, 4).empty());
}

TEST_CASE("breaks: whatever the unit and however narrow") {
  for (const char* unit : {"1e-9", "1e-3", "1", "1e6", "1e12"}) {
    const std::string text = "1e0*(v > 0.7310585e0) + max(0, v - 2e0)";
    std::string scaled = text;
    for (auto at = scaled.find("e0"); at != std::string::npos; at = scaled.find("e0")) {
      scaled.replace(at, 2, std::string("*") + unit);
    }
    INFO(scaled);
    const double size = std::stod(unit);
    const auto found = places(scaled, 1, 20 * size);
    REQUIRE(found.size() == 2);
    CHECK(found[0] == Approx(0.7310585 * size).epsilon(4e-15));
    CHECK(found[1] == Approx(2 * size).epsilon(4e-15));
  }
  CHECK(places("(v > 0.5) + abs(v - 0.503)") == Speeds{0.5, 0.503});
  CHECK(places("abs(v - 3.3) < 1e-7").size() == 2);
}

TEST_CASE("breaks: elsewhere to rounding") {
  for (const char* c : {"0.0123", "sqrt(2)", "exp(1.5)", "17.77"}) {
    INFO(c);
    const double v = Expression(c, {}, {})({});
    for (const std::string& text : {"v^2 + 0.01*(v >= " + std::string(c) + ")",
                                    "exp(-v) + max(0, v - " + std::string(c) + ")",
                                    "max(0, v^2 - (" + std::string(c) + ")^2)^2"}) {
      const auto found = places(text);
      INFO(text);
      REQUIRE(found.size() == 1);
      CHECK(found[0] == Approx(v).epsilon(4e-15));
    }
  }
  CHECK(places("rint(3*v)").size() == 60);
}

TEST_CASE("breaks: none where a function is smooth, however steep, nor in rounding") {
  for (const char* smooth :
       {"tanh((v - 0.5)/1e-6)", "exp(-((v - 3)/1e-4)^2)", "abs(v)^0.5", "abs(v)^1.5", "v^9",
        "sin(300*v)", "v^2 - 0.25", "(1 - cos(v))/v^2", "0*abs(v - 1)", "abs(v - 1)^2",
        "1 + tanh((v - 5)/0.2)", "v > 0 ? v : 2*v", "1/(1 + exp(-1000*(v - 1)))",
        "v > 2 && v > -1 ? v : v"}) {
    INFO(smooth);
    CHECK(places(smooth).empty());
    CHECK(shape(smooth).resolved);
  }
}

TEST_CASE("breaks: kinks, jumps, infinite slopes and poles are told apart") {
  using Kind = Break::Kind;
  const auto kind = [](const std::string& text) { return shape(text).breaks.at(0).kind; };
  CHECK(kind("abs(v - 0.7)") == Kind::kink);
  CHECK(kind("max(0, v - 0.7)^2") == Kind::kink);
  CHECK(kind("v > 0.7") == Kind::jump);
  CHECK(kind("v - 1e-6*(v > 0.7)") == Kind::jump);
  CHECK(kind("sqrt(abs(v - 0.7))") == Kind::steep);
  CHECK(kind("max(0, v - 0.7)^0.7") == Kind::steep);
  CHECK(kind("log(abs(v - 0.69))") == Kind::steep);
  CHECK(kind("1/(v - 0.7)") == Kind::pole);
  CHECK(kind("1/sqrt(abs(v - 0.7))") == Kind::pole);
}

// What lies between two places is interpolated by a polynomial of degree 7 to 1e-10.
TEST_CASE("breaks: places show every feature") {
  for (const char* text : {"exp(-((v - 3.7)/1e-4)^2)", "tanh(1e5*(v - 0.5))", "sin(40*v)",
                           "1/(1 + ((v - 8)/1e-3)^2)", "v*exp(-v)", "(v + 1)^0.3"}) {
    const Expression f(text, {"v"}, {});
    const auto ends = shape(text).places;
    INFO(text);
    REQUIRE(ends.size() > 2);
    for (std::size_t n = 1; n < ends.size(); ++n) {
      if (ends[n] - ends[n - 1] < 1e-13) continue;
      CHECK(stickslip::model::interpolation_error([&](double v) { return f({v}); }, ends[n - 1],
                                                  ends[n]) < 2e-10);
    }
  }
  CHECK_FALSE(shape("sin(1e7*v)").resolved);
}

TEST_CASE("breaks: of two at one place the stronger one stays") {
  using Kind = Break::Kind;
  std::vector<Break> found{{0.5, Kind::kink}, {2, Kind::kink}};
  stickslip::model::merge(found, {{0.5, Kind::pole}, {1, Kind::jump}});
  REQUIRE(found.size() == 3);
  CHECK(found[0].kind == Kind::pole);
  CHECK(found[1].v == 1);
  CHECK(found[2].v == 2);
}

// The 8 nodes make it exact up to degree 7; at degree 8 the error is 2 (width/4)^8.
TEST_CASE("breaks: the error of interpolation") {
  using stickslip::model::interpolation_error;
  const auto power = [](int n) { return [n](double v) { return std::pow(v, n); }; };
  CHECK(interpolation_error(power(7), 0.5, 1.5) < 1e-13);
  CHECK(interpolation_error(power(8), 0.5, 1.5) == Approx(2 * std::pow(0.25, 8)).epsilon(1e-6));
  CHECK(interpolation_error([](double v) { return v > 1; }, 0.5, 1.5) > 0.1);
  CHECK(std::isnan(interpolation_error([](double v) { return std::sqrt(v - 1); }, 0.5, 1.5)));
  const auto window = [](double v) { return std::abs(v - 0.7) < 1e-9 ? 1.0 : 0.0; };
  CHECK(interpolation_error(window, 0.5, 1.5) == 0);
  CHECK(interpolation_error(window, 0.5, 1.5, {0.7}) == 1);
}
