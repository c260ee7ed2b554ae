#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/scenes.hpp"
#include "stickslip/run/evaluation.hpp"

using namespace stickslip;
using cases::Quantity;
using cases::Route;
using cases::Scheme;
using quantities::Result;
using run::Evaluation;
using test::relative_difference;
using test::scene;

namespace {

cases::Case given(const model::Scene& s, Route route, std::set<Quantity> quantities) {
  cases::Case r;
  r.scene = s;
  r.method.route = route;
  r.question.quantities = std::move(quantities);
  r.question.accuracy = 1e-8;
  return r;
}

Evaluation evaluate(const cases::Case& r, const test::Discrete& d) {
  linalg::SolverStatistics statistics;
  return run::evaluate({PETSC_COMM_WORLD, r, d, statistics});
}

const Result& result(const Evaluation& evaluation, std::string_view key) {
  for (const auto& r : evaluation.results) {
    if (r.key == key) return r;
  }
  throw std::invalid_argument(std::string(key));
}

double check_value(const Evaluation& evaluation, const std::string& name) {
  for (const auto& check : evaluation.checks) {
    if (check.name == name) return check.value;
  }
  throw std::invalid_argument(name);
}

bool is_on_grid(const test::Discrete& d) { return d.velocities->keeps_origin(); }  // upwind

model::Scene weakening() {
  auto s = scene(1, 0.5, 1, 0.5, {1, 0});
  s.friction_name = "stribeck";
  s.friction.stribeck = {0.1, 1};
  return s;
}

const std::vector<model::Scene>& sample_scenes() {
  static const std::vector<model::Scene> scenes{
      scene(1, 0.25, 1, 0.25, {1, 0}),    // mu_d on a noise level
      scene(1, 0.3, 1, 0.5, {1, 0}),      // and off
      scene(1, 1, 1, 0.5, {1, 0}),        // mu_d = mu_s
      scene(3, 0.25, 1, 0.5, {1, 0}),     // long sticking phases
      scene(0.2, 0.15, 1, 0.5, {1, 0}),   // k = 0
      scene(0.7, 0.4, 2, 0.5, {0.5, 1}),  // cubic drag
      scene(1, 0.5, 1, 0.5, {0, 0}),      // no drag: holding states at the truncation velocity
      weakening()};                       // levels that leave a speed to both sides
  return scenes;
}

std::vector<test::Discrete> discretisations(const model::Scene& s) {
  return {test::on_hp(s, 5, 1e-9), test::on_upwind(s, 4)};
}

/// What method excursion and the closed form for the noise give on a discretisation, by key.
std::map<std::string, double> known_values(const model::Scene& s, const test::Discrete& d) {
  std::map<std::string, double> known;
  const auto r = given(s, Route::excursion, {Quantity::sticking, Quantity::moments});
  for (const auto& result : evaluate(r, d).results) known[result.key] = result.value[0];
  const int k = d.process.highest_static();
  const auto noise = model::noise_moments(d.process.noise, -k, k);
  known["P_X_le_mu_s"] = noise.within;
  known["E_X2"] = noise.square;
  return known;
}

const std::set<Quantity> kAverages{Quantity::sticking, Quantity::moments, Quantity::noise_law};

}  // namespace

TEST_CASE("routes: hitting times and the null vector give what excursions give") {
  for (const auto& s : sample_scenes()) {
    for (const auto& d : discretisations(s)) {
      const auto known = known_values(s, d);
      const auto by_hitting = evaluate(given(s, Route::hitting, {Quantity::sticking}), d);
      const auto by_null_vector = evaluate(given(s, Route::null_vector, kAverages), d);
      CHECK(by_hitting.results.size() == 5);
      CHECK(by_null_vector.results.size() == 11);
      for (const auto* found : {&by_hitting, &by_null_vector}) {
        for (const auto& r : found->results) {
          INFO(r.key << " at mu_s " << s.friction.mu_s << " mu_d " << s.friction.mu_d);
          CHECK(relative_difference(r.value[0], known.at(r.key)) < 1e-9);
          CHECK(r.error[0] <= 1e-9 * std::abs(r.value[0]));
        }
      }
    }
  }
}

TEST_CASE("routes: a small lambda gives what excursions give, within its stated error") {
  for (const auto& s : sample_scenes()) {
    for (const auto& d : discretisations(s)) {
      const auto known = known_values(s, d);
      const auto found = evaluate(given(s, Route::lambda, kAverages), d);
      CHECK(found.results.size() == 8);
      for (const auto& r : found.results) {
        INFO(r.key << " at mu_s " << s.friction.mu_s << " mu_d " << s.friction.mu_d);
        CHECK(std::abs(r.value[0] - known.at(r.key)) <= r.error[0]);
        CHECK(r.error[0] <= 1e-7 * std::abs(r.value[0]));
      }
      CHECK(check_value(found, "largest_relative_bias") <= 0.25e-8);
    }
  }
}

// Times of relaxation of 1e5: what the bias asks for is far below the lambda at which rounding
// takes over, and between them lies a lambda that serves both.
TEST_CASE(
    "routes: the search for lambda ends near the best one, however small an error is wanted") {
  const auto s = scene(5, 0.25, 1, 0.25, {1, 0});
  const auto d = test::on_hp(s, 6);
  const double known = known_values(s, d).at("P_slide");
  for (double accuracy : {1e-6, 1e-7, 1e-8, 1e-10, 1e-15}) {
    auto r = given(s, Route::lambda, {Quantity::sticking});
    r.question.accuracy = accuracy;
    const auto found = evaluate(r, d);
    const auto& p_slide = result(found, "P_slide");
    INFO("accuracy " << accuracy << " lambda " << check_value(found, "lambda"));
    CHECK(std::abs(p_slide.value[0] - known) <= p_slide.error[0]);
    CHECK(p_slide.error[0] <= 5e-7 * known);
  }
}

TEST_CASE("routes: all agree on any number of ranks", "[parallel]") {
  const auto s = scene(1, 0.5, 1, 0.5, {0, 0});
  for (const auto& d : {test::on_hp(s, 3, 1e-6), test::on_upwind(s, 2, 1e-5)}) {
    const auto known = known_values(s, d);
    for (Route route : {Route::lambda, Route::hitting, Route::null_vector}) {
      for (const auto& r : evaluate(given(s, route, {Quantity::sticking}), d).results) {
        INFO(r.key);
        CHECK(relative_difference(r.value[0], known.at(r.key)) < 1e-8);
      }
    }
  }
}

TEST_CASE("routes: the bias of a fixed lambda is stated, and of first order") {
  for (const auto& s : sample_scenes()) {
    const auto d = test::on_hp(s, 4, 1e-8);
    const auto known = known_values(s, d);
    auto r = given(s, Route::lambda, kAverages);
    const auto at = [&](double lambda) {
      r.question.lambda = {lambda};
      return evaluate(r, d);
    };
    const auto coarse = at(1e-3 / s.tau), fine = at(0.5e-3 / s.tau);
    CHECK(check_value(coarse, "lambda") == r.question.lambda[0] * 2);
    for (const auto& result_of_coarse : coarse.results) {
      const auto& key = result_of_coarse.key;
      const double bias = std::abs(result_of_coarse.value[0] - known.at(key));
      if (bias == 0) continue;  // E_V
      INFO(key << " at mu_s " << s.friction.mu_s << " mu_d " << s.friction.mu_d);
      CHECK(bias <= result_of_coarse.error[0]);
      const double ratio = bias / std::abs(result(fine, key).value[0] - known.at(key));
      CHECK(ratio > 1.7);
      CHECK(ratio < 2.3);
    }
  }
}

TEST_CASE("routes: the null vector is one, and a probability on a grid") {
  for (const auto& s : sample_scenes()) {
    for (const auto& d : discretisations(s)) {
      const auto found = evaluate(given(s, Route::null_vector, {Quantity::moments}), d);
      CHECK(check_value(found, "norm_pi_M_over_norm_M") <= 1e-10);
      if (is_on_grid(d)) CHECK(check_value(found, "most_negative_pi") >= -1e-15);
    }
  }
}

// Row sums of K vanish and f depends on x alone: the scheme leaves the distribution of the noise as
// it is.
TEST_CASE("routes: P(|X| <= mu_s) is the binomial sum at every p") {
  struct Case {
    double delta, known;
  };
  for (const auto& c : {Case{0.5, 51766.0 / 65536}, Case{0.25, 0.739564523423343}}) {
    const auto s = test::on_full_noise(scene(1, 0.25, 1, c.delta, {1, 0}));
    for (int p : {1, 2, 8}) {
      if (p == 8 && c.delta < 0.5) continue;  // seconds, and nothing new
      const auto d = test::on_upwind(s, p);
      const auto exact = evaluate(given(s, Route::null_vector, {Quantity::noise_law}), d);
      CHECK(relative_difference(result(exact, "P_X_le_mu_s").value[0], c.known) < 1e-12);
      CHECK(relative_difference(result(exact, "E_X2").value[0], 1) < 1e-12);
      const auto biased = evaluate(given(s, Route::lambda, {Quantity::noise_law}), d);
      const auto& within = result(biased, "P_X_le_mu_s");
      CHECK(std::abs(within.value[0] - c.known) <= within.error[0]);
      CHECK(within.error[0] < 1e-8);
    }
  }
}

TEST_CASE("routes: without drag excursions agree with the fluid queue") {
  // Bounds the probability that rounding loses, and the errors that follow from it: up to 3e-12,
  // by the reference BLAS.
  constexpr double queue_rounding = 1e-11;
  for (const auto& s : {scene(1, 1, 1, 0.5, {0, 0}), scene(1, 0.5, 1, 0.25, {0, 0}),
                        scene(0.2, 0.15, 1, 0.5, {0, 0}), scene(0.7, 0.3, 2, 0.5, {0, 0})}) {
    auto r = given(s, Route::excursion,
                   {Quantity::sticking, Quantity::moments, Quantity::entry_law, Quantity::laplace});
    r.question.lambda = {0, 0.1, 3};
    const auto d = test::on_hp(s, 11, 1e-13);
    const auto found = evaluate(r, d);
    r.method.route = Route::fluid_queue;
    r.method.scheme = Scheme::none;
    const auto known = evaluate(r, {d.process, nullptr});
    CHECK(known.results.size() == 14);
    for (const auto& exact : known.results) {
      const auto& values = result(found, exact.key).value;
      REQUIRE(values.size() == exact.value.size());
      for (std::size_t n = 0; n < values.size(); ++n) {
        INFO(exact.key << " at mu_d " << s.friction.mu_d << " number " << n);
        CHECK(relative_difference(values[n], exact.value[n]) < 1e-9);
        CHECK(exact.error[n] <= queue_rounding * exact.value[n]);
      }
    }
    CHECK(std::abs(check_value(known, "riccati_residual")) < 1e-14);
    CHECK(std::abs(check_value(known, "lost_probability")) < queue_rounding);
  }
}

TEST_CASE("routes: the fluid queue leaves the noise its distribution") {
  const auto s = test::on_full_noise(scene(1, 0.3, 1, 0.25, {0, 0}));
  auto r = given(s, Route::fluid_queue, {Quantity::noise_law});
  r.method.scheme = Scheme::none;
  const auto found = evaluate(r, {s.meant(), nullptr});
  CHECK(found.results.size() == 2);
  CHECK(relative_difference(result(found, "P_X_le_mu_s").value[0], 0.739564523423343) < 1e-12);
  CHECK(relative_difference(result(found, "E_X2").value[0], 1) < 1e-12);
}

TEST_CASE("routes: only what is asked for is given, with what fields need", "[parallel]") {
  const auto s = sample_scenes()[2];
  const auto d = test::on_hp(s, 3, 1e-6);
  const auto keys = [](const Evaluation& evaluation) {
    std::set<std::string> names;
    for (const auto& r : evaluation.results) names.insert(r.key);
    return names;
  };
  using Keys = std::set<std::string>;
  for (Route route : {Route::lambda, Route::null_vector}) {
    CHECK(keys(evaluate(given(s, route, {Quantity::noise_law}), d)) == Keys{"P_X_le_mu_s", "E_X2"});
  }
  const auto modes = evaluate(given(s, Route::excursion, {Quantity::relaxation}), d);
  CHECK(keys(modes) == Keys{"relaxation_even", "relaxation_even_frequency", "relaxation_odd",
                            "relaxation_odd_frequency"});
  REQUIRE(modes.modes.size() == 2);
  for (const auto& sector : modes.modes) CHECK(sector.modes.size() == 4);
  CHECK_FALSE(modes.distribution);
  auto r = given(s, Route::excursion, {Quantity::resolvent});
  r.question.lambda = {2};
  r.question.observables = {model::parse_observable("stick", s.friction)};
  CHECK(keys(evaluate(r, d)) == Keys{"h_plus", "h_minus", "w_one", "u(stick)", "w_plus(stick)",
                                     "w_minus(stick)", "pi(stick)", "mu(stick)"});
  r.question.quantities = {Quantity::laplace};
  const auto laplace = evaluate(r, d);
  CHECK(keys(laplace) == Keys{"F_slide", "F_stick", "F_excursion", "mean_slide", "mean_stick",
                              "mean_excursion", "var_slide", "var_stick", "var_excursion",
                              "f_slide_0", "f_stick_0"});
  CHECK(laplace.distribution);
}
