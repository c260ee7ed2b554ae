#include <cmath>

#include "../common/catch.hpp"
#include "stickslip/model/drag.hpp"

using stickslip::model::Drag;
using stickslip::model::parse_drag;
using stickslip::model::UnfitLaw;

namespace {

Drag read(const std::string& text, double bias = 0) {
  return parse_drag(text, {0.5, 0.25}, 2, 6, bias);
}

std::string refusal(const std::string& text, double bias = 0) {
  try {
    (void)read(text, bias);
  } catch (const UnfitLaw& unfit) {
    CHECK_FALSE(unfit.fix().empty());
    return unfit.what();
  }
  return "none";
}

// Under a bias that friction does not balance.
std::string driven(const std::string& text) { return refusal(text, 2); }

}  // namespace

TEST_CASE("drag laws: read with the constants of the model") {
  const Drag b = read("-v*mu_s - mu_d*v*abs(v) - tau*v^3");
  CHECK(b(2) == -1 - 1 - 16);
  CHECK(b(-2) == 18);
  CHECK(b.odd());
}

TEST_CASE("drag laws: steep, saturating, slow and one-sided ones are sound") {
  for (const char* text :
       {"-v - 0.1*v*abs(v)", "-tanh(v)", "-atan(v)", "-v^5", "-sinh(3*v)", "-1e4*v^3", "0*v",
        "-tanh(1000*v)", "-v*sqrt(abs(v))", "max(-1, min(1, -v))", "1-exp(v)", "-asinh(v)",
        "v > 0 ? -v : -3*v", "-v + 1e-4*v^3", "abs(v) < 1 ? -v : -v - 5*(v - sign(v))"}) {
    INFO(text);
    CHECK(refusal(text) == "none");
  }
}

TEST_CASE("drag laws: sound as far as velocities go, twice the terminal one") {
  CHECK(read("-v").reach >= 12);
  CHECK(read("-v").reach <= 12.5);
  CHECK(read("-tanh(v)").reach >= 51 / 1.25);  // in the tail of exp(-(mu_d + 1) v)
}

TEST_CASE("drag laws: what is none is refused, with the place") {
  CHECK_THAT(refusal("-v +"), Catch::Contains("Unexpected end of expression"));
  CHECK_THAT(refusal("-c*v"), Catch::Contains("\"c\""));
  CHECK_THAT(refusal("0.5 - v"), Catch::Contains("is 0.5 at v = 0"));
  CHECK_THAT(refusal("-cosh(v)"), Catch::Contains("is -1 at v = 0"));
  CHECK_THAT(refusal("v"), Catch::Contains("drives a body for ever from about v = 0.2"));
  CHECK_THAT(refusal("-1/v"), Catch::Contains("infinite at v = 0"));
  CHECK_THAT(refusal("-v^1.5"), Catch::Contains("not a number at v = "));
  CHECK_THAT(refusal("-v/(5 - abs(v))"), Catch::Contains("at v = 5"));
  // On the other side only.
  CHECK_THAT(refusal("v > 0 ? -v : v"), Catch::Contains("from about v = -0.2"));
  for (const char* one_sided : {"v < -3 ? sqrt(-5 - v) : -v", "v < -3 ? 1/0*v : -v"}) {
    CHECK_THAT(refusal(one_sided), Catch::Contains("at v = -3"));
  }
  CHECK_THAT(driven("v < 0 ? 0 : -v"), Catch::Contains("it is 0 at v = -"));
  CHECK_THAT(driven("v > 0 ? 0 : -v"), Catch::Contains("it is 0 at v = 4e+06"));
}

// Beside mu_d = 1/4.
TEST_CASE("drag laws: one that rises is sound where friction and drag still slow a fast body") {
  for (const char* text : {"0.3*(1 - exp(-10*abs(v)))*sign(v) - v", "-v/(1 + v^2)", "0.24*tanh(v)",
                           "-v - 0.01*exp(-((abs(v) - 3)*200)^2)*sign(v)", "v - 0.01*v^3"}) {
    INFO(text);
    CHECK(refusal(text) == "none");
    CHECK(read(text).rises_until == read(text).reach);
  }
  CHECK(read("-v - v^3").rises_until == 0);
  CHECK_THAT(refusal("0.26*tanh(v)"),
             Catch::Contains("drives a body for ever from about v = 1.9") &&
                 Catch::Contains("friction takes 0.25"));
  CHECK_THAT(refusal("-v + 0.2*v*abs(v)"), Catch::Contains("for ever from about v = 5.1"));
  CHECK_THAT(refusal("0.2*tanh(v)", 0.1), Catch::Contains("the mean force 0.1 drives"));
  CHECK_THAT(refusal("sqrt(abs(v))*sign(v)/10 - v"), Catch::Contains("infinitely steep"));
  CHECK_THAT(refusal("abs(v) < 1 ? -v : -0.9*v"), Catch::Contains("at v = 1,"));
}

TEST_CASE("drag laws: friction that weakens is what holds a fast body") {
  const stickslip::model::Friction weak{1, 0.25, {}, {}, stickslip::model::Stribeck{0.1}};
  CHECK_NOTHROW(parse_drag("0.24*tanh(v)", weak, 1, 8));
  CHECK_THROWS_AS(parse_drag("0.26*tanh(v)", weak, 1, 8), UnfitLaw);
}

TEST_CASE("drag laws: jumps and infinite slopes are refused, with the place") {
  CHECK_THAT(refusal("-sqrt(abs(v))*sign(v)"),
             Catch::Contains("slope") && Catch::Contains("at v = 1.72072833e-09"));
  CHECK_THAT(refusal("-sign(v)"), Catch::Contains("slope"));
  CHECK_THAT(refusal("-v - 0.1*sign(v)"), Catch::Contains("slope"));
  CHECK_THAT(refusal("-sign(v)*abs(v)^0.98"), Catch::Contains("slope"));
  CHECK_THAT(refusal("abs(v) < 1 ? -v : -1.1*v"),
             Catch::Contains("jumps from -1 to -1.1 at v = 1;") && Catch::Contains("hold a body"));
  CHECK_THAT(refusal("v > -2 ? -v : -v + 0.1"), Catch::Contains("jumps from 2 to 2.1 at v = -2;"));
  CHECK_THAT(refusal("abs(v) < 1 ? -v : -v - sign(v)*(abs(v) - 1)^0.3"),
             Catch::Contains("at v = 1,"));
  CHECK_THAT(refusal("-v - sign(v)*0.1*(abs(v) > sqrt(2)*1e-6)"),
             Catch::Contains("at v = 1.41421356e-06;"));
  CHECK_THAT(refusal("-v - sign(v)*max(0, abs(v) - 1)^0.7"), Catch::Contains("at v = 1,"));
}

TEST_CASE("drag laws: kinks on either side are breaks, and none else") {
  using Speeds = std::vector<double>;
  CHECK(read("-v - max(0, abs(v) - 0.5)*sign(v)").breaks == Speeds{0.5});
  CHECK(read("-min(abs(v), mu_s + mu_d)*sign(v) - 0.1*v").breaks == Speeds{0.75});
  CHECK(read("-v - max(0, v - 0.3) + max(0, -v - 1.5)").breaks == Speeds{0.3, 1.5});
  CHECK(read("-v - max(0, v - 0.3) + max(0, -v - 1.5)").mirrored().breaks == Speeds{0.3, 1.5});
  for (const char* smooth : {"-v - 0.1*v*abs(v)", "-tanh(v)", "-tanh(1000*v)", "-v^5", "0*v",
                             "-0.2*v - atan(20*(v - 0.5)) - atan(20*(v + 0.5))"}) {
    INFO(smooth);
    CHECK(read(smooth).breaks.empty());
  }
  CHECK_THAT(refusal("-rint(20*v)/20 - v - 0*max(0, v)"), Catch::Contains("jumps"));
}

// Where (mu_d - |bias|) v + drag has cost 51 in the logarithm of the density.
TEST_CASE("drag laws: known to be sound as far as the density reaches") {
  const auto reach = [](const char* text, double bias) {
    return parse_drag(text, {1, 0.5}, 1, 1000, bias).reach;
  };
  CHECK(reach("-1e-9*v", 0) == Approx(51 / 0.5).epsilon(0.03));
  for (double bias : {0.25, -0.25}) {
    CHECK(reach("-1e-9*v", bias) == Approx(51 / 0.25).epsilon(0.03));
  }
  // Beyond mu_d the density rises to v = 10 before it falls.
  CHECK(reach("-v", 10.5) == Approx(10 + std::sqrt(102.0)).epsilon(0.03));
  CHECK(reach("-v", -10.5) == Approx(10 + std::sqrt(102.0)).epsilon(0.03));
}

TEST_CASE("drag laws: the side with less drag decides how far they are tried") {
  for (const char* text : {"v > 0 ? -v : -0.1*v", "v > 0 ? -0.1*v : -v"}) {
    const Drag b = parse_drag(text, {1, 0.01}, 1, 0.5);
    CHECK(b.reach == Approx(2 * 5).epsilon(0.05));
    CHECK_FALSE(b.odd());
  }
}

TEST_CASE("drag laws: what is left at rest is compared with dry friction") {
  CHECK_THROWS_AS(parse_drag("1e-15 - v", {1, 1e-3}, 1, 6), UnfitLaw);
  CHECK_NOTHROW(parse_drag("1e-17 - v", {1, 1e-3}, 1, 6));
}

// What a law is like follows from its formula, in any unit of length: no speed is special.
TEST_CASE("drag laws: the same in metres and in nanometres") {
  for (const char* unit : {"1", "1e3", "1e9", "1e-6"}) {
    const double u = std::stod(unit);
    const auto of_unit = [&](std::string text) {
      for (auto at = text.find('u'); at != std::string::npos; at = text.find('u')) {
        text.replace(at, 1, unit);
      }
      return parse_drag(text, {u, 0.5 * u}, 1, 12 * u, 0, u * u);
    };
    INFO(unit);
    const Drag kinked = of_unit("-0.5*v - 5*max(v - 2*u, 0)");
    CHECK_FALSE(kinked.odd());
    REQUIRE(kinked.breaks.size() == 1);
    CHECK(kinked.breaks[0] == Approx(2 * u).epsilon(1e-14));
    CHECK(kinked.reach / u == Approx(of_unit("-0.5*v").reach / u).epsilon(1e-12));
    CHECK(of_unit("-v").reach / u == Approx(9.61).epsilon(0.02));
    CHECK(of_unit("-tanh(v/(1e-9*u))*u").slope_at_rest() == Approx(-1e9).epsilon(1e-6));
    CHECK(of_unit("-4e-13*v").slope_at_rest() == Approx(-4e-13).epsilon(1e-9));
    CHECK(of_unit("-v - 0.01*v*abs(v)/(1*u)").bounds_velocity());
    CHECK_THROWS_AS(of_unit("-sign(v)*sqrt(abs(v)/(1*u))*u"), UnfitLaw);
    CHECK_THROWS_AS(of_unit("abs(v) < 2*u ? -v : -1.1*v"), UnfitLaw);
  }
}

// However narrow: 1e-4 of v, between all places at which a law can be tried.
TEST_CASE("drag laws: a narrow feature is seen") {
  const Drag bump = parse_drag("-0.5*v - 5*exp(-((v - 0.921)/1e-4)^2)", {1, 0.5}, 1, 12);
  CHECK_FALSE(bump.odd());
  CHECK(bump.rises_until == bump.reach);
  CHECK(bump.terminal_velocity(1) == Approx(0.921).margin(5e-4));
  CHECK(bump.balances(-1).empty());
  CHECK(bump.balances(1).size() == 3);
  CHECK(bump.steepest(2) > 2e4);
  CHECK(bump.mirrored().terminal_velocity(1) == Approx(2).epsilon(1e-6));
  CHECK_THAT(refusal("-v + 0*sin(1e7*v) - 0.1*v*sin(1e7*v)"), Catch::Contains("changes too often"));
}
