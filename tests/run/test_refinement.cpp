#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "../common/catch.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/run/carry_out.hpp"
#include "stickslip/run/estimates.hpp"
#include "stickslip/run/refine.hpp"

using namespace stickslip;
using cases::Quantity;
using run::Outcome;

namespace {

cases::Case given(double mu_s, double mu_d, double tau, double delta, model::Drag drag) {
  cases::Case r;
  r.scene.friction = {mu_s, mu_d};
  r.scene.tau = tau;
  r.scene.delta = delta;
  r.scene.drag = drag;
  r.question.quantities = {Quantity::sticking, Quantity::moments, Quantity::entry_law};
  return r;
}

Outcome solve(const cases::Case& r) { return run::carry_out(PETSC_COMM_WORLD, r, {}, {}); }

const quantities::Result& result(const Outcome& outcome, std::string_view key) {
  for (const auto& r : outcome.results) {
    if (r.key == key) return r;
  }
  throw std::invalid_argument(std::string(key));
}

double value(const Outcome& outcome, const std::string& key) {
  return result(outcome, key).value[0];
}

quantities::Results solved_alone(const cases::Case& r, int n) {
  const auto resolution = run::RefinementSequence(r).refinement_level(n);
  return run::solve_on(PETSC_COMM_WORLD, r, resolution).evaluation.results;
}

// Error estimates of a refinement level from its values and those before, solved one by one.
quantities::Results estimated(const cases::Case& r, int n) {
  const run::RefinementSequence sequence(r);
  quantities::Results found = solved_alone(r, sequence.first());
  run::Changes changes;
  for (int m = sequence.first() + 1; m <= n; ++m) {
    const auto coarse = std::exchange(found, solved_alone(r, m));
    changes = run::add_discretisation(sequence.error_per_change(m), coarse, changes, found);
  }
  return found;
}

// Times a step takes from the times of those before.
std::vector<double> expected_seconds(const cases::Case& r, Outcome& outcome) {
  std::vector<double> expected;
  outcome = run::carry_out(
      PETSC_COMM_WORLD, r,
      [&](int, const run::Resolution&, double seconds) { expected.push_back(seconds); }, {});
  return expected;
}

double work(const cases::Case& r, int n) {
  return run::relative_work(r.scene, run::RefinementSequence(r).refinement_level(n));
}

// The value of one hand-made discretisation.
double at_degree(cases::Case r, int degree, const char* key) {
  r.method.degree = degree;
  return value(solve(r), key);
}

}  // namespace

TEST_CASE("refinement: hp errors fall tenfold and more with two degrees", "[slow][real]") {
  for (const auto& r : {given(1, 0.25, 1, 1.0 / 4, {1, 0}), given(1, 0.25, 1, 1.0 / 16, {1, 0}),
                        given(1, 1, 1, 1.0 / 4, {0, 0})}) {
    const double reference = at_degree(r, 15, "P_stick");
    double before = std::abs(at_degree(r, 3, "P_stick") - reference);
    for (int degree : {5, 7, 9}) {
      const double error = std::abs(at_degree(r, degree, "P_stick") - reference);
      INFO("degree " << degree << ": " << before << " to " << error);
      CHECK(error < before / 10);
      before = error;
    }
  }
}

TEST_CASE("refinement: estimates of fixed upwind grids cover their errors", "[slow][real]") {
  cases::Case r = given(1, 0.25, 1, 1.0 / 2, {1, 0});
  cases::Case fine = r;
  fine.question.accuracy = 1e-11;
  const Outcome exact = solve(fine);
  r.method.scheme = cases::Scheme::upwind;
  for (int p : {1, 2, 3, 16, 64}) {
    r.method.points = p;
    const Outcome outcome = solve(r);
    CHECK(outcome.steps.size() == 2);
    for (const char* key : {"P_stick", "P_slide", "E_V2", "E_absV", "mean_slide"}) {
      const double error = std::abs(value(outcome, key) - value(exact, key));
      INFO(key << " at p = " << p);
      CHECK(result(outcome, key).error[0] > 0.8 * error);
      CHECK(result(outcome, key).error[0] < 10 * error);
    }
  }
}

TEST_CASE("refinement: what is zero by symmetry is exactly zero", "[parallel]") {
  cases::Case r = given(1, 0.25, 1, 0.5, {1, 0});
  r.question.quantities = {Quantity::moments};
  const Outcome outcome = solve(r);
  CHECK(value(outcome, "E_V") == 0);
  CHECK(result(outcome, "E_V").error[0] == 0);
}

TEST_CASE("refinement: no error is below the rounding of the value") {
  // Without drag on a full range nothing but rounding changes from one discretisation to the next.
  cases::Case r = given(1, 0.3, 1, 0.5, {0, 0});
  r.question.accuracy = 1e-10;
  const Outcome outcome = solve(r);
  for (const auto& found : outcome.results) {
    for (std::size_t e = 0; e < found.value.size(); ++e) {
      CHECK(found.error[e] >= 4 * 2.2e-16 * std::abs(found.value[e]));
    }
  }
}

// With a single static level every discretisation gives the same mean duration of sticking.
TEST_CASE("refinement: no error is below what all discretisations cut off") {
  cases::Case r = given(0.4, 0.3, 1, 0.5, {0, 0});
  r.question.quantities = {Quantity::sticking};
  r.question.accuracy = 1e-2;
  const Outcome outcome = solve(r);
  const double cut = outcome.steps.back().resolution.truncation;
  REQUIRE(cut > 1e-9);
  for (const auto& found : outcome.results) CHECK(found.error[0] >= cut * found.value[0]);
}

TEST_CASE("refinement: only what is asked for is done") {
  cases::Case r = given(1, 0.25, 1, 0.5, {1, 0});
  r.question.quantities = {Quantity::noise_law};
  const Outcome noise = solve(r);
  CHECK(noise.total.assemblies == 0);
  CHECK(noise.results.size() == 2);
  CHECK(noise.reached);

  const auto factorizations = [](const Outcome& o) {
    return o.total.factorizations_real + o.total.factorizations_complex;
  };
  r.question.quantities = {Quantity::sticking, Quantity::moments, Quantity::noise_law};
  const Outcome even = solve(r);
  const int steps = static_cast<int>(even.steps.size());
  CHECK(even.total.assemblies == steps);
  CHECK(factorizations(even) == steps);
  CHECK(even.total.solves == steps);

  r.question.quantities = {Quantity::entry_law};
  const Outcome both = solve(r);
  CHECK(factorizations(both) == 2 * static_cast<int>(both.steps.size()));
}

TEST_CASE("refinement: a fixed discretisation is not refined, and its errors are reported") {
  cases::Case r = given(1, 0.25, 1, 0.25, {1, 0});
  r.question.quantities = {Quantity::sticking};
  r.method.degree = 3;
  const Outcome coarse = solve(r);
  CHECK(coarse.steps.size() == 3);
  CHECK_FALSE(coarse.reached);
  CHECK_THAT(coarse.shortfall, Catch::Contains("-degree"));
  r.question.accuracy = 0.1;
  CHECK(solve(r).reached);
}

TEST_CASE("refinement: rounding is distinguished from discretisation") {
  cases::Case r = given(1, 0.25, 1.0 / 64, 0.5, {1, 0});
  r.question.quantities = {Quantity::sticking, Quantity::moments};
  r.question.accuracy = 1e-15;
  const Outcome outcome = solve(r);
  CHECK_FALSE(outcome.reached);
  CHECK_THAT(outcome.shortfall, Catch::Contains("rounding"));
}

// Between rare pulses a body rests: most modes lie in a continuous spectrum, and their frequencies
// are those of the elements.
TEST_CASE("refinement: modes without a digit end early, and what is asked for beside them stays") {
  auto r = given(1, 0.07, 1, 1, {1.5, 0.85});
  r.question.quantities = {Quantity::sticking, Quantity::relaxation};
  r.question.accuracy = 1e-2;
  r.scene.noise.name = "file";
  const std::vector<model::Level> rows{{-3.4, 7, 0}, {-0.12, 0.0084, 0.00012}, {3.8, 0, 7}};
  r.scene.noise.table = std::make_shared<const model::LevelTable>(rows);
  const auto outcome = solve(r);
  CHECK_FALSE(outcome.reached);
  CHECK_THAT(outcome.shortfall, Catch::Contains("refinement cannot resolve") &&
                                    Catch::Contains("relaxation_frequency"));
  CHECK(outcome.steps.size() < 10);  // of 17
  const auto& rates = result(outcome, "relaxation");
  for (std::size_t n = 0; n < rates.value.size(); ++n) {
    CHECK((rates.error[n] <= 0.1 * rates.value[n] || rates.error[n] >= rates.value[n]));
  }
  CHECK(result(outcome, "P_stick").error[0] < 1e-2 * value(outcome, "P_stick"));
}

TEST_CASE("refinement: the upwind scheme reports early what an accuracy would take") {
  cases::Case r = given(1, 0.25, 1, 0.25, {1, 0});
  r.question.quantities = {Quantity::sticking};
  r.method.scheme = cases::Scheme::upwind;
  r.question.accuracy = 1e-9;
  const Outcome outcome = solve(r);
  CHECK_FALSE(outcome.reached);
  CHECK(outcome.steps.size() < 6);
  const auto& step = outcome.steps.back();
  const double needed = step.resolution.points * step.estimate / r.question.accuracy;
  CHECK_THAT(outcome.shortfall, Catch::Contains(fmt::format("p = {:.1e}", needed)) &&
                                    Catch::Contains(fmt::format("{:.0e}", 2 * step.estimate)));
}

TEST_CASE("refinement: refuses what cannot fit before allocating it") {
  cases::Case r = given(1, 0.25, 1, 1.0 / 64, {1, 0});
  r.method.scheme = cases::Scheme::upwind;
  r.method.points = 5000000;
  CHECK_THROWS_AS(solve(r), NoMemory);
}

TEST_CASE("refinement: estimates are made of the last changes, and of the errors of the solution "
          "method") {
  struct Case {
    cases::Method method;
    model::Drag drag;
    double accuracy;
    int steps;
  };
  const auto c = GENERATE(Case{{}, {0.1, 3}, 1e-5, 4}, Case{{}, {0.1, 3}, 1e-6, 5},
                          Case{{}, {0.1, 3}, 1e-7, 5}, Case{{.degree = 4}, {1, 0}, 1e-5, 3},
                          Case{{.scheme = cases::Scheme::upwind, .points = 16}, {1, 0}, 1e-5, 2});
  cases::Case r = given(1, 0.25, c.drag.cubic > 0 ? 4 : 1, c.drag.cubic > 0 ? 0.25 : 0.5, c.drag);
  r.question.accuracy = c.accuracy;
  r.method = c.method;
  const Outcome outcome = solve(r);
  CHECK(static_cast<int>(outcome.steps.size()) == c.steps);
  const auto expected = estimated(r, run::RefinementSequence(r).first() + c.steps - 1);
  double largest = 0;
  std::string key;
  REQUIRE(expected.size() == outcome.results.size());
  for (std::size_t n = 0; n < expected.size(); ++n) {
    const auto& found = outcome.results[n];
    for (std::size_t e = 0; e < found.value.size(); ++e) {
      INFO(found.key << " number " << e);
      CHECK(found.error[e] == Approx(expected[n].error[e]).epsilon(1e-6).margin(1e-14));
    }
    if (quantities::relative_error(expected[n]) <= largest) continue;
    largest = quantities::relative_error(expected[n]);
    key = found.key;
  }
  CHECK(outcome.steps.back().estimate == Approx(largest).epsilon(1e-6));
  CHECK(outcome.steps.back().limiting_key == key);
  CHECK(outcome.reached == (largest <= r.question.accuracy));
}

// From degree 5 to 6 the error of E_V2 hardly falls, so that its change vanishes; the other means
// change little, too.
TEST_CASE("refinement: a change that vanishes by accident hides no error") {
  cases::Case r = given(1, 0.0138, 0.069, 0.0945, {0.243, 0.104});
  r.question.quantities = {Quantity::sticking, Quantity::moments};
  r.scene.noise.deviation = 0.567;
  r.scene.friction.mu_s_minus = 1.3;
  r.question.accuracy = 1e-4;
  const auto found = solve(r);
  REQUIRE(found.steps.back().resolution.degree == 6);
  const double error = std::abs(value(found, "E_V2") - at_degree(r, 12, "E_V2"));
  CHECK(error <= result(found, "E_V2").error[0]);
}

TEST_CASE("refinement: an accuracy is reached at its estimate, and not below") {
  cases::Case r = given(1, 0.25, 1, 0.5, {1, 0});
  r.method.degree = 4;
  const double estimate = solve(r).steps.back().estimate;
  r.question.accuracy = 1.001 * estimate;
  CHECK(solve(r).reached);
  r.question.accuracy = 0.999 * estimate;
  CHECK_FALSE(solve(r).reached);
}

TEST_CASE("refinement: the density is judged by the distribution of |V|", "[parallel]") {
  cases::Case r = given(1, 0.25, 1, 0.5, {1, 0});
  r.question.quantities = {Quantity::density};
  r.method.degree = 4;
  const run::RefinementSequence sequence(r);
  const auto at = [&](int step) {
    return run::solve_on(PETSC_COMM_WORLD, r, sequence.refinement_level(step))
        .evaluation.distribution;
  };
  const auto coarse = at(0), fine = at(1);
  const double distance = quantities::distance(quantities::speed_distribution(*coarse),
                                               quantities::speed_distribution(*fine));
  CHECK(solve(r).speed_error == Approx(distance).epsilon(1e-9));
  CHECK(distance > 1e-6);
}

TEST_CASE("refinement: a truncation velocity by hand is an error of the time spent at it") {
  cases::Case r = given(1, 0.25, 1, 0.5, {1, 0});
  r.question.quantities = {Quantity::sticking};
  r.scene.v_max = 1;
  r.method.degree = 5;
  r.question.accuracy = 0.5;
  const Outcome outcome = solve(r);
  CHECK(outcome.reached);
  const auto solved = run::solve_on(PETSC_COMM_WORLD, r, outcome.steps.back().resolution);
  const auto speed = quantities::speed_distribution(*solved.evaluation.distribution);
  const double share = speed.at_top / (1 - speed.at_rest);
  CHECK(share > 0.01);
  r.question.accuracy = 1.02 * share;
  CHECK(solve(r).reached);
  r.question.accuracy = 0.98 * share;
  const Outcome held = solve(r);
  CHECK_FALSE(held.reached);
  CHECK_THAT(held.shortfall, Catch::Contains(fmt::format("excludes {:.1e}", share)));
}

TEST_CASE("refinement: a digit more takes the steps by which estimates fall") {
  const bool hp = GENERATE(true, false);
  cases::Case r = hp ? given(1, 0.25, 4, 0.25, {0.1, 3}) : given(1, 0.25, 1, 0.5, {1, 0});
  r.question.quantities = {Quantity::sticking, Quantity::moments};
  r.question.accuracy = hp ? 1e-6 : 0.05;
  if (hp) r.question.quantities.insert(Quantity::entry_law);
  if (!hp) r.method.scheme = cases::Scheme::upwind;
  const Outcome outcome = solve(r);
  REQUIRE(outcome.reached);
  const int last = static_cast<int>(outcome.steps.size()) - 1;
  REQUIRE(last >= (hp ? 3 : 1));
  const int first = run::RefinementSequence(r).first();
  double seconds = 0;
  for (const auto& step : outcome.steps) seconds += step.seconds;
  int more = 4;  // 2^4 > 10, of first order
  if (hp) {
    const double ratio = outcome.steps[last - 1].estimate / outcome.steps[last].estimate;
    for (more = 1; std::pow(ratio, more) < 10;) ++more;
    CHECK(more <= 3);
  }
  const double expected = seconds * work(r, first + last + more) / work(r, first + last);
  CHECK(outcome.next_digit_seconds == Approx(expected).epsilon(1e-12));
}

TEST_CASE("refinement: a step is expected to take the time of the last one, by its work") {
  cases::Case r = given(1, 0.25, 1, 0.25, {1, 0});
  r.question.accuracy = 1e-5;
  Outcome outcome;
  const auto expected = expected_seconds(r, outcome);
  REQUIRE(expected.size() == outcome.steps.size());
  CHECK(expected[0] == 0);
  for (int step = 1; step < static_cast<int>(expected.size()); ++step) {
    const int n = run::RefinementSequence(r).first() + step;
    const double ratio = work(r, n) / work(r, n - 1);
    CHECK(expected[step] == Approx(outcome.steps[step - 1].seconds * ratio).epsilon(1e-12));
  }
}

TEST_CASE("refinement: the solver statistics of a run are those of its steps") {
  cases::Case r = given(1, 0.25, 1, 0.5, {1, 0});
  r.question.quantities = {Quantity::sticking, Quantity::moments};
  const Outcome outcome = solve(r);
  linalg::SolverStatistics sum;
  for (const auto& step : outcome.steps) sum += step.statistics;
  CHECK(outcome.total.solves == sum.solves);
  CHECK(outcome.total.corrections == sum.corrections);
  CHECK(outcome.total.factorization_seconds == sum.factorization_seconds);
  CHECK(outcome.total.backward_error == sum.backward_error);
}

TEST_CASE("refinement: closed forms and paths need no system, all else does") {
  const auto needs = [](std::set<Quantity> quantities, cases::Route route) {
    cases::Case r;
    r.question.quantities = std::move(quantities);
    r.method.route = route;
    return run::needs_system(r);
  };
  using enum Quantity;
  using cases::Route;
  CHECK_FALSE(needs({noise_law}, Route::excursion));
  CHECK(needs({noise_law}, Route::null_vector));
  CHECK_FALSE(needs({noise_law, trajectory, sensitivity}, Route::excursion));
  CHECK(needs({sticking}, Route::excursion));
  CHECK(needs({noise_law, trajectory, sensitivity, moments}, Route::excursion));
}

TEST_CASE("refinement: what reduced models miss on coarse grids ends no refinement") {
  cases::Case r = given(1, 0.5, 1, 0.25, {1, 0});
  r.question.quantities = {Quantity::slip};
  for (int k = 0; k <= 12; ++k) {
    r.question.distance.push_back(0.03 * std::pow(10 / 0.03, k / 12.0));
  }
  r.question.accuracy = 1e-3;
  CHECK(solve(r).reached);
}

// The noise damps most waves: at omega = 1000 they are 3e-6 of the spectrum, at 1e4 less than 1e-8.
// The two frequencies beside one that misses the accuracy share its error.
TEST_CASE("refinement: elements follow the waves that count, and no others", "[slow][real]") {
  auto r = given(1, 0.5, 1, 0.25, {1, 0});
  r.question.quantities = {Quantity::spectrum};
  r.question.omega = {1000, 1500, 2000, 10000};
  r.question.accuracy = 1e-6;
  const Outcome outcome = solve(r);
  REQUIRE(outcome.reached);
  CHECK(outcome.steps.back().resolution.waves == std::vector<double>{1000, 1500, 2000});
  r.question.omega = {10000};
  r.method.degree = 6;
  const Outcome followed = solve(r);
  CHECK(followed.steps.back().resolution.waves == r.question.omega);
  const double known = value(followed, "S_v");
  CHECK(std::abs(result(outcome, "S_v").value[3] - known) <= 1e-6 * known);
}

TEST_CASE("refinement: a spectrum that a coarse grid makes negative at 0 has no half width") {
  cases::Case r = given(1, 0.9275472130746147, 0.34511921289195263, 0.0625, {0, 0});
  r.scene.bias = 0.14093038741631342;
  r.question.quantities = {Quantity::spectrum};
  r.question.omega = {1};
  r.method.degree = 1;
  const Outcome outcome = solve(r);
  CHECK_FALSE(outcome.reached);
  CHECK(value(outcome, "S_0") < 0);
  CHECK(result(outcome, "S_0").error[0] > std::abs(value(outcome, "S_0")));
  CHECK(std::isnan(value(outcome, "fwhm")));
}

// The last line of defence: whatever the error estimates say, a probability above 1 is no result.
TEST_CASE("refinement: results outside their bounds are not said to be reached") {
  auto r = given(1, 0.25, 1, 0.5, {1, 0});
  r.question.quantities = {Quantity::averages};
  model::Observable f{.name = "f", .value = [](double, double, double) { return 2; }};
  f.quadratic = true;
  r.question.observables = {f};
  CHECK(solve(r).reached);  // 2 is its mean
  f.least = 0, f.most = 1;
  r.question.observables = {f};
  const auto outcome = solve(r);
  CHECK_FALSE(outcome.reached);
  CHECK_THAT(outcome.shortfall, Catch::StartsWith("pi(f) is 2"));
}
