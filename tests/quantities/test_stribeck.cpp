#include <cmath>
#include <map>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/solved.hpp"
#include "stickslip/model/drag.hpp"
#include "stickslip/quantities/engines/excursions.hpp"

using namespace stickslip;
using test::relative_difference;
using test::scene;
using test::Solved;

namespace {

model::Scene weakening(double mu_d, double velocity, double exponent = 1) {
  auto s = scene(1, mu_d, 1, 0.25, {1, 0});
  s.friction_name = "stribeck";
  s.friction.stribeck = {velocity, exponent};
  return s;
}

using Values = std::map<std::string, double>;

Values values(const test::Discrete& d) {
  const Solved solved(d);
  quantities::Results results;
  const auto& excursion = solved.distribution.excursion();
  quantities::append_sticking(excursion, results);
  quantities::append_moments(solved.distribution.discretisation(), excursion, results);
  Values values;
  for (const auto& r : results) values[r.key] = r.value[0];
  return values;
}

Values values(const model::Scene& s, int degree = 11) { return values(test::on_hp(s, degree)); }

}  // namespace

TEST_CASE("stribeck: what does not weaken is Coulomb friction, to the last bit") {
  const auto coulomb = values(scene(1, 1, 1, 0.25, {1, 0}));
  for (const auto& [key, value] : values(weakening(1, 0.1))) CHECK(value == coulomb.at(key));
}

// A body that leaves a speed to both sides stays near it for times of the order of v_s log(1/v_s).
// Friction that falls late is mu_s, but for v/v_s.
TEST_CASE("stribeck: falls at once or never in the limits, with first order") {
  const auto at_once = values(scene(1, 0.5, 1, 0.25, {1, 0})),
             never = values(scene(1, 1, 1, 0.25, {1, 0}));
  for (const char* key : {"P_stick", "mean_slide", "E_V2"}) {
    const auto off = [&](double velocity, const Values& limit) {
      return values(weakening(0.5, velocity), 9).at(key) - limit.at(key);
    };
    INFO(key);
    CHECK(off(2000, never) / off(1000, never) == Approx(0.5).epsilon(0.01));
    CHECK(std::abs(off(2000, never)) < 1e-3 * never.at(key));
    CHECK(off(1e-4, at_once) / off(2e-4, at_once) == Approx(0.53).epsilon(0.06));
    CHECK(std::abs(off(1e-4, at_once)) < 1e-2 * at_once.at(key));
  }
}

TEST_CASE("stribeck: power that noise puts in is dissipated, with any exponent and by direction") {
  for (double exponent : {0.5, 1.0, 2.0}) {
    auto s = weakening(0.5, 0.2, exponent);
    s.friction.mu_s_minus = 1.3;
    s.bias = 0.1;
    Solved solved(test::on_hp(s, 12));
    quantities::Results results;
    const auto& distribution = solved.distribution;
    quantities::append_moments(distribution.discretisation(), distribution.excursion(), results);
    quantities::append_averages(distribution, solved.systems.at(0, generator::Symmetry::none).a(),
                                {}, results);
    Values found;
    for (const auto& r : results) found[r.key] = r.value[0];
    CHECK(relative_difference(found.at("E_XV") + 0.1 * found.at("E_V"),
                              found.at("friction_power") + found.at("E_V2")) < 1e-9);
    const auto f = model::friction_power(s.friction);
    CHECK(f(0, 1, 0.2) == Approx(0.2 * (0.5 + 0.5 * std::exp(-1))));
    CHECK(f(0, -1, -0.2) == Approx(0.2 * (0.5 + 0.8 * std::exp(-1))));
  }
}
