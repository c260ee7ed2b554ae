#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/near.hpp"
#include "../common/scenes.hpp"
#include "stickslip/run/routes.hpp"

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

model::Scene asymmetric(const model::Drag& drag = {1, 0}) {
  auto s = test::biased(scene(1, 0.4, 1, 0.5, drag), 0.2);
  s.friction.mu_s_minus = 1.3;
  s.friction.mu_d_minus = 0.7;
  return s;
}

model::Scene five(double bias, const model::Drag& drag = {1, 0}) {
  return test::biased(test::with_table(scene(1, 0.5, 1, 1, drag), test::five_states()), bias);
}

// 55 states, many of which are starts.
model::Scene sine(const model::Drag& drag = {1, 0.5}) {
  auto s =
      test::with_table(scene(0.8, 0.4, 1, 1, drag), test::sine_and_levels(1, 5, 5, 0.6, 1, 0.8, 2));
  s.friction.mu_s_minus = 0.9;
  return test::biased(s, 0.1);
}

model::Scene on_levels(const std::vector<model::Level>& levels, double bias,
                       const model::Drag& drag = {1, 0}) {
  auto s = test::biased(scene(1, 0.4, 1, 0.25, drag), bias);
  s.noise.name = "file";
  s.noise.table = std::make_shared<const model::LevelTable>(levels);
  return s;
}

const std::vector<model::Level> kUneven{
    {-1.4, 1, 0}, {-0.3, 2, 0.5}, {0.2, 1, 1}, {0.9, 0.7, 3}, {1.7, 0, 2}},
    kEven{{-1.5, 1, 0}, {-0.5, 1, 1}, {0.5, 1, 1}, {1.5, 0, 1}};

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

// Without symmetry, and with noises of few states.
const std::vector<model::Scene>& other_scenes() {
  static const std::vector<model::Scene> scenes{
      asymmetric(),
      asymmetric({0, 0}),
      test::biased(scene(0.2, 0.15, 1, 0.5, {1, 0}), -0.3),
      on_levels(kEven, 0),
      on_levels(kUneven, 0.05),
      five(0),
      five(0.15),
      sine()};
  return scenes;
}

// The queue knows no drag.
std::vector<model::Scene> scenes_without_drag() {
  auto weak = scene(1, 0.5, 1, 0.5, {0, 0});  // with states at the force mu_d
  weak.noise_levels = 6;
  // Two states at that force which are not alike, and jump to one another.
  const model::LevelTable still({-2, -0.7, 0, 0.6, 0.6, 2}, {{0, 1, 2},
                                                             {1, 0, 0.3},
                                                             {1, 2, 1},
                                                             {2, 3, 0.7},
                                                             {3, 4, 0.5},
                                                             {3, 1, 0.2},
                                                             {4, 3, 1.2},
                                                             {4, 5, 0.3},
                                                             {5, 4, 2},
                                                             {5, 0, 0.1}});
  return {scene(1, 1, 1, 0.5, {0, 0}),
          scene(1, 0.5, 1, 0.25, {0, 0}),
          scene(0.2, 0.15, 1, 0.5, {0, 0}),
          scene(0.7, 0.3, 2, 0.5, {0, 0}),
          asymmetric({0, 0}),
          on_levels(kUneven, 0.05, {0, 0}),
          five(0, {0, 0}),
          five(0.15, {0, 0}),
          sine({0, 0}),
          test::with_table(weak, test::twice(weak.meant().noise, 0.3)),
          test::with_table(scene(1, 0.6, 1, 1, {0, 0}), still)};
}

std::vector<test::Discrete> discretisations(const model::Scene& s) {
  return {test::on_hp(s, 5, 1e-9), test::on_upwind(s, 4)};
}

const std::set<Quantity> kAverages{Quantity::sticking, Quantity::moments, Quantity::noise_law,
                                   Quantity::averages};

cases::Case averages_by(const model::Scene& s, Route route) {
  auto r = given(s, route, kAverages);
  std::vector<std::string> functions{"v^2"};
  // A small lambda is small beside the mean of every function, and takes its time where that
  // vanishes.
  if (route != Route::lambda)
    functions.insert(functions.end(), {"x*v + v", "y == 0 ? x + 1 : v*v*v"});
  for (const auto& f : functions) {
    r.question.observables.push_back(model::parse_observable(f, s.friction));
  }
  return r;
}

/// What method excursion and the closed form for the noise give on a discretisation, by key.
std::map<std::string, double> known_values(const model::Scene& s, const test::Discrete& d) {
  std::map<std::string, double> known;
  for (const auto& r : evaluate(averages_by(s, Route::excursion), d).results) {
    known[r.key] = r.value[0];
  }
  const auto& noise = d.process.noise;
  const auto moments = model::noise_moments(noise, noise.first_from(-s.friction.mirrored().mu_s),
                                            noise.last_up_to(s.friction.mu_s));
  known["P_X_le_mu_s"] = moments.within;
  known["E_X2"] = moments.square;
  return known;
}

}  // namespace

// One table: scene x quantity x method, each discretisation for itself.
TEST_CASE("routes: hitting times and the null vector give what excursions give") {
  for (const auto* scenes : {&sample_scenes(), &other_scenes()}) {
    for (std::size_t n = 0; n < scenes->size(); ++n) {
      const auto& s = (*scenes)[n];
      for (const auto& d : discretisations(s)) {
        const auto known = known_values(s, d);
        const auto by_hitting = evaluate(given(s, Route::hitting, {Quantity::sticking}), d);
        const auto by_null_vector = evaluate(averages_by(s, Route::null_vector), d);
        CHECK(by_hitting.results.size() == 5);
        CHECK(by_null_vector.results.size() > 11);
        for (const auto* found : {&by_hitting, &by_null_vector}) {
          for (const auto& r : found->results) {
            INFO(r.key << " of scene " << n << " " << s.noise.name << ", bias " << s.bias
                       << ", mu_s " << s.friction.mu_s << ": " << r.value[0] << " +- " << r.error[0]
                       << " for " << known.at(r.key));
            const double size = std::abs(known.at(r.key)), zero = size == 0 ? 1e-12 : 0;
            CHECK(std::abs(r.value[0] - known.at(r.key)) <= 1e-9 * size + zero);
            // What vanishes by symmetry is a sum of terms of the size 1, and so is its rounding.
            CHECK(r.error[0] <= 1e-9 * (size == 0 ? 1 : size));
          }
        }
        CHECK(check_value(by_null_vector, "norm_pi_M_over_norm_M") <= 1e-10);
        if (is_on_grid(d)) CHECK(check_value(by_null_vector, "most_negative_pi") >= -1e-15);
      }
    }
  }
}

TEST_CASE("routes: a small lambda gives what excursions give, within its stated error") {
  std::vector<std::pair<model::Scene, test::Discrete>> all;
  for (const auto& s : sample_scenes()) {
    for (const auto& d : discretisations(s)) all.emplace_back(s, d);
  }
  for (const auto& s : {asymmetric(), five(0.15), sine()})
    all.emplace_back(s, test::on_hp(s, 5, 1e-9));
  for (const auto& [s, d] : all) {
    const auto known = known_values(s, d);
    const auto found = evaluate(averages_by(s, Route::lambda), d);
    CHECK(found.results.size() > 8);
    for (const auto& r : found.results) {
      INFO(r.key << " under " << s.noise.name << ", bias " << s.bias << ", mu_s " << s.friction.mu_s
                 << ": " << r.value[0] << " +- " << r.error[0] << " for " << known.at(r.key));
      CHECK(std::abs(r.value[0] - known.at(r.key)) <= r.error[0]);
      CHECK(r.error[0] <= 1e-7 * std::abs(r.value[0]));
    }
    CHECK(check_value(found, "largest_relative_bias") <= 0.25e-8);
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

// Psi of the queue has nothing in common with elements in v, which see no speeds beyond theirs.
TEST_CASE("routes: without drag excursions agree with the fluid queue") {
  // Bounds the probability that rounding loses, and the errors that follow from it: up to 3e-12,
  // by the reference BLAS.
  constexpr double queue_rounding = 1e-11;
  for (const auto& s : scenes_without_drag()) {
    auto r = given(s, Route::excursion,
                   {Quantity::sticking, Quantity::moments, Quantity::entry_law, Quantity::laplace});
    r.question.lambda = {0, 0.1, 3};
    const auto d = test::on_hp(s, 11, 1e-13);
    const auto found = evaluate(r, d);
    r.method.route = Route::fluid_queue;
    r.method.scheme = Scheme::none;
    const auto known = evaluate(r, {d.process, nullptr});
    CHECK(known.results.size() >= 14);
    for (const auto& exact : known.results) {
      const auto& values = result(found, exact.key).value;
      REQUIRE(values.size() == exact.value.size());
      for (std::size_t n = 0; n < values.size(); ++n) {
        INFO(exact.key << " of " << s.noise.name << " at mu_d " << s.friction.mu_d << ", bias "
                       << s.bias << ", number " << n << ": " << values[n] << " for "
                       << exact.value[n]);
        CHECK(std::abs(values[n] - exact.value[n]) <= 1e-9 * std::abs(exact.value[n]));
        CHECK(exact.error[n] <= queue_rounding * std::abs(exact.value[n]));
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
