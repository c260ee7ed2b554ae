#include <cmath>

#include "../common/catch.hpp"
#include "../common/scenes.hpp"
#include "stickslip/case/duration_rows.hpp"
#include "stickslip/quantities/plan.hpp"
#include "stickslip/run/carry_out.hpp"

using namespace stickslip;
using cases::Case;
using cases::Quantity;
using generator::Symmetry;
using test::scene;

namespace {

/// Counts on one discretisation.
struct Counts {
  int assemblies, factorizations, solves;
  friend bool operator==(const Counts&, const Counts&) = default;
};

std::ostream& operator<<(std::ostream& out, const Counts& c) {
  return out << c.assemblies << " assemblies, " << c.factorizations << " factorisations, "
             << c.solves << " solves";
}

struct Example {
  const char* name;
  std::set<Quantity> quantities;
  Counts expected;
  model::Scene of = scene(1, 0.25, 1, 0.5, {1, 0});
  std::vector<double> lambda = {};
  std::vector<const char*> observables = {};
};

model::Scene inclined() {
  auto s = scene(1, 0.25, 1, 0.5, {1, 0});
  s.bias = 0.3;
  return s;
}

model::Scene without_drag() {
  auto s = scene(1, 0.25, 1, 0.5, {0, 0});
  s.drag_name = "none";
  return s;
}

model::Scene truncated() {
  auto s = scene(1, 0.25, 1, 0.5, {1, 0});
  s.v_max = 3;
  return s;
}

const std::vector<Example>& samples() {
  using enum Quantity;
  static const std::vector<Example> all{
      {"noise alone", {noise_law}, {0, 0, 0}},
      {"noise and its derivatives", {noise_law, sensitivity}, {0, 0, 0}},
      {"a trajectory", {trajectory}, {0, 0, 0}},
      {"sticking", {sticking}, {1, 1, 1}},
      {"sticking and moments", {sticking, moments, noise_law}, {1, 1, 1}},
      {"with the density", {sticking, moments, noise_law, density}, {1, 1, 1}},
      {"the hitting distribution asks for odd functions", {sticking, entry_law}, {2, 2, 2}},
      {"sticking alone", {stick_duration_transform}, {1, 1, 1}, truncated(), {0.1, 1, 10}},
      {"transforms of durations", {laplace}, {3, 3, 9}, truncated(), {0.5, 2}},
      {"transforms at 0 share the system of the stationary distribution",
       {laplace},
       {2, 2, 9},
       truncated(),
       {0, 2}},
      {"a resolvent", {resolvent}, {2, 2, 2}, without_drag(), {0.5}, {"v^2", "x*v", "stick"}},
      {"transforms and resolvent share systems",
       {laplace, resolvent},
       {4, 4, 13},
       without_drag(),
       {0, 0.5},
       {}},
      {"derivatives", {sticking, sensitivity}, {4, 1, 3}},
      {"derivatives of moments too", {sticking, moments, sensitivity}, {4, 1, 6}},
      {"derivatives with one static level",
       {sticking, sensitivity},
       {4, 1, 2},
       scene(0.2, 0.15, 1, 0.5, {1, 0})},
      {"derivatives without drag", {sticking, sensitivity}, {3, 1, 3}, without_drag()},
      {"a bias", {sticking, moments}, {1, 1, 2}, inclined()},
      {"a bias and averages", {moments, averages, entry_law}, {1, 1, 2}, inclined(), {}, {"x*v"}},
      {"averages cost nothing more",
       {moments, averages},
       {1, 1, 1},
       truncated(),
       {},
       {"v^2", "abs(v)"}},
      {"a bias and transforms", {laplace, resolvent}, {2, 2, 10}, inclined(), {1}, {"v", "x*v"}},
      {"a bias and derivatives", {sticking, moments, sensitivity}, {4, 1, 14}, inclined()}};
  return all;
}

Case given(const Example& c) {
  Case r;
  r.scene = c.of;
  r.question.quantities = c.quantities;
  r.question.lambda = c.lambda;
  r.question.accuracy = 1e-4;
  for (const char* f : c.observables) {
    r.question.observables.push_back(model::parse_observable(f, r.scene.friction));
  }
  return r;
}

}  // namespace

TEST_CASE("plan: what is predicted is what is done") {
  for (const auto& c : samples()) {
    INFO(c.name);
    const Case r = given(c);
    const auto plan = run::needs_system(r) ? quantities::plan_of(r) : quantities::Plan{};
    CHECK_FALSE(plan.adaptive());
    const Counts predicted{plan.assemblies(), plan.factorizations(), plan.solves()};
    CHECK(predicted == c.expected);
    const auto outcome = run::carry_out(PETSC_COMM_WORLD, r, {}, {});
    if (c.expected.factorizations == 0) {
      CHECK(outcome.steps.empty());
      continue;
    }
    REQUIRE(outcome.steps.size() >= 2);
    for (const auto& step : outcome.steps) {
      const auto& l = step.statistics;
      const Counts done{l.assemblies, l.factorizations_real + l.factorizations_complex, l.solves};
      CHECK(done == c.expected);
    }
  }
}

TEST_CASE("plan: what shares a system follows each other, and lets it go") {
  using enum Quantity;
  const auto plan = quantities::plan_of(
      given({"", {resolvent, laplace, sticking, peak}, {}, truncated(), {0.5, 2}, {"v^2"}}));
  std::vector<std::string> names;
  for (const auto& task : plan.tasks) names.push_back(task.name);
  CHECK(names ==
        std::vector<std::string>{"stationary distribution", "moments of durations",
                                 "Laplace transforms at lambda = 0.5", "resolvent at lambda = 0.5",
                                 "Laplace transforms at lambda = 2", "resolvent at lambda = 2"});
  const auto uses = [&plan](std::size_t from, double lambda) {
    return plan.used_from(from).contains({lambda, Symmetry::even});
  };
  CHECK(uses(1, 0));
  CHECK_FALSE(uses(2, 0));
  CHECK(uses(3, 0.5));
  CHECK_FALSE(uses(4, 0.5));
  CHECK(uses(5, 2));
}

TEST_CASE("plan: adaptive tasks are marked, and take complex arithmetic for comparison alone") {
  using enum Quantity;
  for (Quantity q : {spectrum, duration_density, autocorrelation, expectation, relaxation}) {
    Case r = given({"", {q}, {}});
    r.question.time = {0.5, 2};
    r.question.observables.push_back(model::parse_observable("v^2", r.scene.friction));
    const auto plan = quantities::plan_of(r);
    CHECK(plan.adaptive());
    CHECK(plan.factorizations() == (q == relaxation ? 0 : 1));
    const auto outcome = run::carry_out(PETSC_COMM_WORLD, r, {}, {});
    const auto& l = outcome.steps.front().statistics;
    CHECK(l.factorizations_real + l.factorizations_complex >= plan.factorizations() + 1);
    CHECK(l.solves >= plan.solves());
    if (!PetscDefined(USE_COMPLEX)) CHECK(l.factorizations_complex <= 4);
  }
}

TEST_CASE("plan: phase_durations takes half of the work of duration_density for the same numbers") {
  Case r = given({"", {}, {}});
  r.question.time = {0.5, 2};
  const auto with = [&](std::set<Quantity> quantities) {
    r.question.quantities = std::move(quantities);
    return run::carry_out(PETSC_COMM_WORLD, r, {}, {});
  };
  const Quantity part = cases::kPhaseDurations.quantity;
  const auto all = with({Quantity::duration_density}), phases = with({part}),
             both = with({Quantity::duration_density, part});
  CHECK(both.results.size() == all.results.size());
  REQUIRE(phases.results.size() + 2 == all.results.size());
  for (std::size_t n = 0; n < phases.results.size(); ++n) {
    INFO(phases.results[n].key);
    CHECK(phases.results[n].key == all.results[n].key);
    CHECK(phases.results[n].value == all.results[n].value);
  }
  const auto& most = all.steps.front().statistics;
  CHECK(phases.steps.front().statistics.solves < 0.7 * most.solves);
}

TEST_CASE("plan: sizes are those of the run, by the analysis alone") {
  for (double delta : {0.5, 0.25}) {
    Case r = given({"", {Quantity::sticking, Quantity::entry_law}, {}});
    r.scene.delta = delta;
    const auto prediction = run::predict(PETSC_COMM_WORLD, r);
    const auto outcome = run::carry_out(PETSC_COMM_WORLD, r, {}, {});
    REQUIRE(prediction.steps.size() == 3);
    double seconds = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& predicted = prediction.steps[n];
      const auto& l = outcome.steps[n].statistics;
      seconds += predicted.seconds;
      CHECK(predicted.unknowns == l.unknowns);
      CHECK(predicted.nonzeros == l.nonzeros);
      CHECK(l.nonzeros > 3 * l.unknowns);  // a diagonal, two jumps and transport
      CHECK(l.nonzeros < 40 * l.unknowns);
      CHECK(predicted.factor_entries > 0.5 * static_cast<double>(l.factor_entries));
      CHECK(predicted.factor_entries < 2 * static_cast<double>(l.factor_entries));
      CHECK(predicted.megabytes <= 2 * l.factor_megabytes + 2);
      CHECK(predicted.megabytes >= 0.5 * l.factor_megabytes - 2);
    }
    CHECK(prediction.seconds == Approx(seconds).epsilon(1e-14));
  }
}

// The odd operator has the size of the even one.
TEST_CASE("plan: operations of all systems are predicted, sizes of the largest") {
  using enum Quantity;
  const auto even =
      run::predict(PETSC_COMM_WORLD, given({"", {density, stick_duration_transform}, {}}));
  auto both = given({"", {density, stick_duration_transform, entry_law}, {}});
  const auto two = run::predict(PETSC_COMM_WORLD, both);
  // Densities at 0+ ask for a degree more.
  const auto &one_step = even.steps.back(), &step = two.steps.back();
  const double growth = static_cast<double>(step.unknowns) / static_cast<double>(one_step.unknowns);
  CHECK(growth < 1.2);
  const double ratio = step.operations / one_step.operations;
  CHECK(ratio > 1.9);
  CHECK(ratio < 2.1 * std::pow(growth, 3));
  CHECK(step.factor_entries < 1.1 * growth * growth * one_step.factor_entries);
}
