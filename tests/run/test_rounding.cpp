#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include "../common/catch.hpp"
#include "../common/near.hpp"
#include "../common/options.hpp"
#include "../common/scenes.hpp"
#include "stickslip/case/passage_rows.hpp"
#include "stickslip/quantities/engines/excursions.hpp"
#include "stickslip/run/routes.hpp"

using namespace stickslip;
using cases::Case;
using cases::Quantity;
using cases::Route;
using quantities::Result;
using quantities::Results;
using quantities::Uncertain;
using run::Evaluation;
using test::relative_difference;
using test::scene;

namespace {

Case given(const model::Scene& s, std::set<Quantity> quantities) {
  Case r;
  r.scene = s;
  r.question.quantities = std::move(quantities);
  r.question.lambda = {0.5};
  for (const char* f : {"v^2", "v"}) {
    r.question.observables.push_back(model::parse_observable(f, s.friction));
  }
  return r;
}

Evaluation evaluate(const Case& r, const test::Discrete& d) {
  linalg::SolverStatistics statistics;
  return run::evaluate({PETSC_COMM_WORLD, r, d, statistics});
}

const Result& result(const Results& results, std::string_view key) {
  for (const auto& r : results) {
    if (r.key == key) return r;
  }
  throw std::invalid_argument(std::string(key));
}

double error(const Results& results, const std::string& key) {
  return result(results, key).error[0];
}

double value(const Results& results, const std::string& key) {
  return result(results, key).value[0];
}

// Solves that leave six digits, which one step of iterative refinement makes twelve.
test::Given rough_solves() {
  return {{"-slide_ksp_type", "gmres"},
          {"-slide_pc_type", "ilu"},
          {"-slide_pc_factor_levels", "3"},
          {"-slide_ksp_rtol", "1e-6"}};
}

model::Scene plain() { return scene(1, 0.25, 1, 0.5, {1, 0}); }

Results all_by_rough_solves() {
  using enum Quantity;
  const auto r = given(plain(), {sticking, moments, entry_law, laplace, resolvent, sensitivity});
  const auto rough = rough_solves();
  return evaluate(r, test::on_hp(r.scene, 5, 1e-8)).results;
}

/// Whatever this solution method gives by direct solves: the table is the program's own, so that a
/// new quantity is among them.
Case given_all(const model::Scene& s) {
  using enum Quantity;
  const std::set<Quantity> by_reduced_models{spectrum,
                                             relaxation,
                                             duration_density,
                                             autocorrelation,
                                             displacement,
                                             expectation,
                                             cases::kPassageTimeDistribution.quantity};
  Case r = given(s, {});
  for (const auto* entry : cases::entries()) {
    const bool gives = entry->routes.contains(Route::excursion);
    if (!gives || entry->of_one_run || by_reduced_models.contains(entry->quantity)) continue;
    r.question.quantities.insert(entry->quantity);
  }
  r.question.inverse_distance = {0.5};
  r.question.velocity = {0.1, 0.5, 1};
  return r;
}

}  // namespace

// Refined values are right; the size of the refinement step stays visible in every error.
TEST_CASE("rounding: every error shows the steps of iterative refinement") {
  auto inclined = plain();
  inclined.bias = 0.3;
  for (const auto& r : {given_all(plain()), given_all(inclined)}) {
    const auto d = test::on_hp(r.scene, 5, 1e-8);
    const auto exact = evaluate(r, d).results;
    const auto rough = rough_solves();
    const auto found = evaluate(r, d).results;
    for (std::size_t n = 0; n < found.size(); ++n) {
      for (std::size_t e = 0; e < found[n].value.size(); ++e) {
        const double size = std::abs(found[n].value[e]);
        INFO(found[n].key << " number " << e << ", bias " << r.scene.bias);
        CHECK(relative_difference(found[n].value[e], exact[n].value[e]) < 1e-11);
        CHECK(exact[n].error[e] <= 1e-13 * size);
        CHECK(found[n].error[e] <= 5e-5 * size);
        if (found[n].key != "f_slide_0" && size > 0) CHECK(found[n].error[e] > 1e-9 * size);
      }
    }
  }
}

TEST_CASE("rounding: derivatives are off by what those of the mean durations are off") {
  const auto found = all_by_rough_solves();
  const double slide = value(found, "mean_slide"), stick = value(found, "mean_stick");
  const double total = slide + stick;
  for (const std::string by : {"_dmu_d", "_dtau", "_ddrag_coefficient"}) {
    INFO(by);
    const double of_slide = error(found, "dmean_slide" + by);
    const double of_stick = error(found, "dmean_stick" + by);
    CHECK(error(found, "dmean_excursion" + by) == Approx(of_slide + of_stick));
    // P_stick = T/(S + T): dP = (S dT - T dS)/(S + T)^2.
    const double of_probability = (slide * of_stick + stick * of_slide) / (total * total);
    CHECK(error(found, "dP_stick" + by) == Approx(of_probability));
    CHECK(error(found, "dP_slide" + by) == Approx(of_probability));
    // M/(S + T): what the durations take alone.
    for (const std::string key : {"E_V2", "E_absV", "E_XV"}) {
      const double by_total = value(found, key) / total * (of_slide + of_stick);
      CHECK(error(found, "d" + key + by) > by_total);
    }
  }
}

// With a single static level all sticking phases are alike, whatever the refinement.
TEST_CASE(
    "rounding: what an identity lacks is added to every number of the stationary distribution",
    "[real]") {
  using enum Quantity;
  double largest = 0;
  for (double mu_d : {0.003, 0.005, 0.01}) {
    const auto r =
        given(scene(0.15, mu_d, 1.0 / 256, 0.25, {1, 0}), {sticking, moments, entry_law});
    const auto d = test::on_hp(r.scene, 6, 1e-9);
    const auto found = evaluate(r, d);
    const double defect = found.distribution->excursion().conservation_defect(d);
    largest = std::max(largest, defect);
    const auto& results = found.results;
    const double stick = value(results, "mean_stick");
    CHECK(error(results, "mean_stick") == Approx(defect * stick).margin(2e-15 * stick));
    for (const auto& each : results) {
      INFO(each.key << " at mu_d " << mu_d);
      CHECK(each.error[0] >= defect * std::abs(each.value[0]));
    }
  }
  // The noise is far faster than sliding phases; but rounding may happen to cancel in one case.
  CHECK(largest > 1e-14);
}

// From the stationary distribution the mean displacement is the drift times t, and nothing else.
TEST_CASE("rounding: of a drift it is what an identity lacks, and grows with the time") {
  auto inclined = scene(1, 0.25, 1, 0.5, {1, 0});
  inclined.bias = -0.3;
  auto r = given(inclined, {Quantity::displacement});
  r.question.accuracy = 1e-2;
  r.question.start.kind = model::Start::Kind::stationary;
  r.question.time = {1, 5};
  const auto d = test::on_hp(r.scene, 4, 1e-6);
  const auto found = evaluate(r, d);
  const double defect = found.distribution->excursion().conservation_defect(d);
  REQUIRE(defect > 0);
  const auto& mean = result(found.results, "displacement_mean");
  REQUIRE(mean.value[0] < 0);
  for (std::size_t n = 0; n < mean.value.size(); ++n) {
    CHECK(mean.error[n] == Approx(defect * std::abs(mean.value[n])).margin(0));
  }
}

TEST_CASE("rounding: averages by hand, with the error of a probability that is known") {
  const Case r = given(plain(), {Quantity::sticking, Quantity::moments, Quantity::noise_law});
  const auto process = r.scene.process(8);
  linalg::SolverStatistics statistics;
  const run::Problem problem{PETSC_COMM_WORLD, r, {process, nullptr}, statistics};
  const double beyond = model::noise_moments(process.noise, -2, 2).beyond;
  for (const auto& [stick, slide] : {std::pair{0.3, 0.7}, {0.9, 0.1}}) {
    const std::vector<Uncertain> values{{beyond * (1 - 1e-3), 0},
                                        {stick, 1e-9},
                                        {slide, 2e-9},
                                        {5, 3e-9},
                                        {6, 4e-9},
                                        {-7, 5e-9},
                                        {0.5, 6e-9},
                                        {8, 7e-9}};
    Results found;
    run::append_averages(problem, values, found);
    CHECK(found.size() == 8);
    // P_stick = 1 - P_slide is no more wrong than the smaller one.
    CHECK(error(found, "P_stick") == Approx(1e-9 + 1e-3 * std::min(stick, slide)));
    CHECK(error(found, "P_slide") == Approx(2e-9 + 1e-3 * slide));
    CHECK(error(found, "E_V2") == Approx(3e-9 + 5e-3));
    CHECK(error(found, "E_absV") == Approx(4e-9 + 6e-3));
    CHECK(error(found, "E_XV") == Approx(5e-9 + 7e-3));
    CHECK(error(found, "P_X_le_mu_s") == Approx(6e-9 + 0.5e-3));
    CHECK(error(found, "E_X2") == Approx(7e-9 + 8e-3));
    CHECK(error(found, "E_V") == 0);
    CHECK(value(found, "E_XV") == -7);
  }
}

TEST_CASE("rounding: of the fluid queue four times its defects, more for fast bodies") {
  auto r = given(scene(1, 0.5, 1, 0.25, {0, 0}),
                 {Quantity::sticking, Quantity::moments, Quantity::laplace});
  r.method.route = Route::fluid_queue;
  const auto found = evaluate(r, {r.scene.process(12), nullptr});
  double defect = std::numeric_limits<double>::epsilon();
  for (const auto& check : found.checks) defect += std::abs(check.value);
  const auto& results = found.results;
  const double speed = value(results, "E_absV") / value(results, "P_slide");
  for (const char* key : {"P_stick", "mean_slide", "E_V2", "E_XV", "F_slide", "F_stick"}) {
    INFO(key);
    const double relative = error(results, key) / value(results, key);
    CHECK(relative == Approx(4 * defect * (1 + speed)).epsilon(1e-6));
  }
}

TEST_CASE("rounding: errors of hitting times show the steps of iterative refinement") {
  auto r = given(plain(), {Quantity::sticking});
  r.method.route = Route::hitting;
  const auto d = test::on_hp(r.scene, 5, 1e-8);
  const auto rough = rough_solves();
  for (const auto& found : evaluate(r, d).results) {
    INFO(found.key);
    CHECK(found.error[0] > 1e-9 * found.value[0]);
    CHECK(found.error[0] < 1e-4 * found.value[0]);
  }
}

// A step of inverse iteration more makes a rough vector a good one, and shows how rough it was.
TEST_CASE("rounding: errors of the null vector show what its last iteration changed") {
  using enum Quantity;
  auto r = given(plain(), {sticking, moments, noise_law});
  const auto d = test::on_upwind(r.scene, 2, 1e-5);
  const auto known = evaluate(r, d).results;
  r.method.route = Route::null_vector;
  const test::Given rough({{"-null_eps_tol", "0.5"}, {"-null_eps_target", "-0.01"}});
  const auto found = evaluate(r, d);
  for (const auto& each : found.results) {
    if (each.value[0] == 0) continue;  // E_V
    INFO(each.key);
    CHECK(each.error[0] > 1e-13 * std::abs(each.value[0]));
  }
  for (const auto& exact : known) {
    if (exact.key.starts_with("P_X") || exact.key == "E_X2") continue;
    INFO(exact.key);
    CHECK(std::abs(value(found.results, exact.key) - exact.value[0]) <=
          error(found.results, exact.key));
  }
}

TEST_CASE("rounding: reduced models take a tenth of the accuracy at most") {
  using enum Quantity;
  auto r = given(plain(), {sticking, moments, spectrum, autocorrelation});
  r.question.omega = {0.3, 2};
  r.question.time = {0.2, 1};
  const auto d = test::on_hp(r.scene, 5, 1e-8);
  for (double accuracy : {1e-3, 1e-6}) {
    r.question.accuracy = accuracy;
    const auto found = evaluate(r, d).results;
    INFO("accuracy " << accuracy);
    CHECK(quantities::relative_error(result(found, "S_v")) <= 0.1 * accuracy);
    for (double each : result(found, "C_vv").error) {
      CHECK(each <= 0.1 * accuracy * value(found, "E_V2"));
    }
  }
}
