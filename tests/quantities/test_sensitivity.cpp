#include <cmath>
#include <map>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/near.hpp"
#include "../common/solved.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/model/noise_chain.hpp"
#include "stickslip/quantities/engines/excursions.hpp"

using namespace stickslip;
using quantities::Results;
using test::relative_difference;
using test::scene;
using test::Solved;

namespace {

using Values = std::map<std::string, double>;

constexpr int kDegree = 11;

Values by_key(const Results& results) {
  Values values;
  for (const auto& r : results) values[r.key] = r.value[0];
  return values;
}

Values scalars(const model::Scene& s) {
  const Solved solved(test::on_hp(s, kDegree));
  Results results;
  quantities::append_sticking(solved.distribution.excursion(), results);
  quantities::append_moments(solved.distribution.discretisation(), solved.distribution.excursion(),
                             results);
  quantities::append_noise_distribution(solved.distribution.process(), results);
  return by_key(results);
}

Values derivatives(const model::Scene& s) {
  Solved solved(test::on_hp(s, kDegree));
  Results results;
  quantities::append_sensitivity(solved.systems, solved.distribution, effects::derivatives_of(s),
                                 true, true, results);
  quantities::append_noise_sensitivity(solved.distribution.process(), results);
  return by_key(results);
}

model::Scene changed(model::Scene s, const std::string& parameter, double by) {
  if (parameter == "mu_d") s.friction.mu_d += by;
  if (parameter == "mu_s") s.friction.mu_s += by;
  if (parameter == "stribeck_velocity") s.friction.stribeck->velocity += by;
  if (parameter == "mu_d_minus") *s.friction.mu_d_minus += by;
  if (parameter == "tau") s.tau += by;
  if (parameter == "drag_coefficient") s.drag.linear += by;
  return s;
}

// Central differences with steps h, h/2, h/4, twice extrapolated: their error is of order h^6.
Values extrapolated(const model::Scene& s, const std::string& parameter, double h) {
  std::vector<Values> difference;
  for (double step : {h, h / 2, h / 4}) {
    const Values above = scalars(changed(s, parameter, step));
    const Values below = scalars(changed(s, parameter, -step));
    Values d;
    for (const auto& [key, value] : above) d[key] = (value - below.at(key)) / (2 * step);
    difference.push_back(std::move(d));
  }
  Values limit;
  for (const auto& [key, coarse] : difference[0]) {
    const double middle = difference[1][key], fine = difference[2][key];
    const double first = (4 * middle - coarse) / 3, second = (4 * fine - middle) / 3;
    limit[key] = (16 * second - first) / 15;
  }
  return limit;
}

}  // namespace

TEST_CASE("sensitivity: adjoints agree with extrapolated differences", "[slow][real]") {
  auto strong = scene(1, 0.9, 0.5, 0.5, {0.5, 0.3});
  auto small = scene(0.2, 0.13, 1, 0.5, {1, 0});  // k = 0
  auto long_sticking = scene(2.6, 0.6, 1, 0.25, {1, 0});
  auto lopsided = scene(1, 0.4, 1, 0.5, {1, 0});
  lopsided.friction.mu_s_minus = 2.2;
  lopsided.friction.mu_d_minus = 0.7;
  strong.drag_name = "cubic";
  auto weakening = scene(1.1, 0.4, 1, 0.5, {1, 0}), by_side = lopsided;
  weakening.friction_name = by_side.friction_name = "stribeck";
  weakening.friction.stribeck = {0.3, 1};
  by_side.friction.stribeck = {0.5, 2};
  by_side.friction.mu_s = 1.1;
  const auto plain = scene(1, 0.5, 1, 1, {1, 0});
  const auto five = test::with_table(plain, test::five_states());
  const auto many_starts =
      test::biased(test::with_table(scene(0.8, 0.4, 1, 1, {1, 0}),
                                    test::sine_and_levels(1.1, 4, 6, 0.6, 1, 0.7, 3)),
                   0.1);
  for (auto s : {strong, small, long_sticking, lopsided, weakening, by_side,
                 test::biased(five, 0.15), many_starts}) {
    std::vector<std::pair<std::string, double>> parameters{
        {"mu_d", 0.004}, {"drag_coefficient", 0.05 * s.drag.linear}};
    if (!s.noise.table) {
      s.noise_levels = s.full_levels() - 1;  // tau changes no number of levels
      parameters.emplace_back("tau", 0.02 * s.tau);
    }
    const Values exact = derivatives(s);
    if (s.friction.mu_d_minus) parameters.emplace_back("mu_d_minus", 0.004);
    if (s.friction.stribeck) {
      parameters.insert(parameters.end(), {{"mu_s", 0.004}, {"stribeck_velocity", 0.01}});
    }
    for (const auto& [parameter, h] : parameters) {
      for (const auto& [key, value] : extrapolated(s, parameter, h)) {
        const auto found = exact.find("d" + key + "_d" + parameter);
        if (found == exact.end() || found->second == 0) {
          CHECK(std::abs(value) < 1e-8);  // E_V, the noise by what is not its own, stays with k = 0
          continue;
        }
        INFO(found->first << " of mu_s " << s.friction.mu_s);
        CHECK(relative_difference(found->second, value) < 1e-7);
      }
    }
  }
}

TEST_CASE("sensitivity: two states a level give what one gives", "[real]") {
  auto weak = scene(1, 0.3, 1, 0.5, {1, 0});
  weak.noise_levels = 5;
  for (double bias : {0.0, 0.2}) {
    weak.bias = bias;
    const auto known = derivatives(weak),
               found = derivatives(test::with_table(weak, test::twice(weak.meant().noise, 0.3)));
    for (const auto& [key, d] : found) {
      if (bias == 0 && key.starts_with("dE_V_")) continue;  // that is 0 by symmetry there
      INFO(key << " bias " << bias);
      CHECK(std::abs(d - known.at(key)) < 1e-10 * (std::abs(d) + 0.01));
    }
  }
}

// One system serves the stationary distribution and all adjoints.
TEST_CASE("sensitivity: one factorisation, one solve a functional") {
  const auto s = scene(1, 0.25, 1, 0.5, {1, 0});
  Solved solved(test::on_hp(s, 4));
  const auto before = solved.statistics;
  Results results;
  const auto append = [&](bool sticking, bool moments) {
    quantities::append_sensitivity(solved.systems, solved.distribution, effects::derivatives_of(s),
                                   sticking, moments, results);
  };
  append(true, false);
  CHECK(solved.statistics.solves - before.solves == 2);
  CHECK(solved.statistics.assemblies - before.assemblies == 3);
  CHECK(solved.statistics.factorizations_real + solved.statistics.factorizations_complex == 1);
  results.clear();
  append(false, true);
  CHECK(solved.statistics.solves - before.solves == 2 + 5);
  CHECK(results.size() == 9);
}

// Sticking phases on one level are exponential: nothing but the rate of the noise changes them.
TEST_CASE("sensitivity: a single static level") {
  const auto s = scene(0.2, 0.13, 1, 0.5, {1, 0});
  const auto exact = derivatives(s);
  CHECK(exact.at("dmean_stick_dmu_d") == 0);
  CHECK(exact.at("dmean_stick_ddrag_coefficient") == 0);
  const double rate = s.process(1).noise.rate();
  CHECK(relative_difference(exact.at("dmean_stick_dtau"), 2 / (s.tau * rate)) < 1e-12);
}

TEST_CASE("sensitivity: a drag law without coefficient has no derivative by it") {
  auto s = scene(1, 0.5, 1, 0.5, {0, 0});
  s.drag_name = "none";
  std::vector<std::string_view> parameters;
  for (const auto& theta : effects::derivatives_of(s)) parameters.push_back(theta.option);
  CHECK(parameters == std::vector<std::string_view>{"mu_d", "tau"});
}

// d E[X^2]/d tau = -1/tau^2 on the full range, where E[X^2] = 1/tau but for tails.
TEST_CASE("sensitivity: the variance of the noise") {
  const model::Process process{{0.7, 0.2, 60}, {1, 0.5}, {1, 0}};
  Results results;
  quantities::append_noise_sensitivity(process, results);
  const auto found = by_key(results);
  CHECK(relative_difference(found.at("dE_X2_dtau"), -1 / 0.49) < 1e-10);
  CHECK(found.at("dP_X_le_mu_s_dtau") > 0);
}

TEST_CASE("sensitivity: closed forms of the noise have the rounding of their sums") {
  const auto process = test::on_full_noise(scene(1, 0.25, 1, 0.25, {1, 0})).meant();
  Results results;
  quantities::append_noise_sensitivity(process, results);
  REQUIRE(results.size() == 2);
  const double rounding = model::rounding_of_sums(process.noise);
  for (const auto& r : results) {
    INFO(r.key);
    // Differences of sums that are some times larger.
    CHECK(r.error[0] >= rounding * std::abs(r.value[0]));
    CHECK(r.error[0] < 1e4 * rounding);
  }
}
