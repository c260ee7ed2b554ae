#include <algorithm>
#include <cmath>

#include "../common/catch.hpp"
#include "../common/options.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/model/drag.hpp"
#include "stickslip/model/observable.hpp"
#include "stickslip/run/discretise.hpp"
#include "stickslip/run/refine.hpp"

using namespace stickslip;
using run::hp_resolution;
using run::levels_for;

namespace {

model::Scene scene(double mu_s, double mu_d, double tau, double delta) {
  model::Scene s;
  s.friction = {mu_s, mu_d};
  s.tau = tau;
  s.delta = delta;
  return s;
}

}  // namespace

// What lies beyond level N weighs, against the level from which the body starts, as in the closed
// distribution of the noise, times (N/first)^2 for second moments, times exp(tilt x).
TEST_CASE("noise range: the first level whose weight with second moments is below the tolerance") {
  struct Case {
    double mu_d, tau, delta;
    model::Drag drag;
    double bias, tilt;
  };
  const auto saturating = model::parse_drag("-v/(1 + abs(v))", {1, 0.25}, 1, 8);
  for (const auto& c :
       {Case{0.25, 1, 0.125, {1, 0}, 0, 0},              // drag rules
        Case{0.25, 1, 0.125, {0, 0}, 0, 2 * 0.25},       // 2 tau mu_d
        Case{3, 1, 0.125, {0, 0}, 0, 2},                 // at most 2 sqrt(tau)
        Case{1, 2, 0.125, {0, 0}, 0, 2 * std::sqrt(2)},  // the same
        Case{1, 1, 0.125, {0.9, 0}, 0, 2},               // weak against mu_d^2
        Case{1, 1, 0.125, {1.1, 0}, 0, 0},               // and not
        Case{0.25, 1, 0.125, saturating, 0, 2}, Case{0.25, 1, 0.125, {1, 0}, -0.4, 0}}) {
    auto s = scene(1, c.mu_d, c.tau, c.delta);
    s.drag = c.drag;
    s.bias = c.bias;
    // With a bias bodies start from the farther edge, at |x| = mu_s + |g|.
    const int first = static_cast<int>(std::floor((1 + std::abs(c.bias)) / c.delta + 1e-9)) + 1;
    const auto distribution = model::stationary_distribution(s.process(s.full_levels()).noise);
    const auto weight = [&](int i) {
      const double share =
          distribution[s.full_levels() + i] / distribution[s.full_levels() + first];
      const double square = static_cast<double>(i) / first;
      return share * square * square * std::exp(c.tilt * c.delta * (i - first));
    };
    for (double tolerance : {1e-3, 1e-9}) {
      const int levels = levels_for(s, tolerance);
      INFO("mu_d " << c.mu_d << " tau " << c.tau << " tilt " << c.tilt << " bias " << c.bias);
      REQUIRE(levels < s.full_levels());
      CHECK(weight(levels) <= tolerance);
      CHECK(weight(levels - 1) > tolerance);
    }
  }
}

TEST_CASE("velocity end: terminal velocity, or where the tail allows a truncation") {
  auto s = scene(1, 0.25, 1, 0.25);
  CHECK(run::velocity_end(s, 32, 1e-12) == 7.75);
  s.drag = {0.001, 0};  // terminal velocity 7750
  CHECK(run::velocity_end(s, 32, 1e-12) < 120);
  s.v_max = 3;
  CHECK(run::velocity_end(s, 32, 1e-12) == 3);
}

TEST_CASE("velocity end: of both signs the faster one counts") {
  auto s = scene(1, 0.25, 1, 0.25);
  for (double bias : {0.4, -0.4}) {
    s.bias = bias;
    CHECK(run::velocity_end(s, 32, 1e-12) == Approx(8 + 0.4 - 0.25));
  }
}

TEST_CASE("resolution: unknowns are levels times nodes, on each velocity branch") {
  const auto s = scene(1, 0.25, 1, 0.25);
  run::Resolution upwind;
  upwind.scheme = cases::Scheme::upwind;
  upwind.levels = 5;
  upwind.points = 4;
  upwind.v_max = 3.125;  // 50 nodes
  CHECK(run::unknowns(s, upwind) == 11 * 50);
  upwind.v_max = 3.13;
  CHECK(run::unknowns(s, upwind) == 11 * 51);
  CHECK(run::discretise(s, upwind).velocities->size() == 51);
  upwind.branches = 2;
  CHECK(run::unknowns(s, upwind) == 2 * 11 * 51);
  const auto hp = hp_resolution(s, 7, 0, 1e-6);
  const int nodes = run::discretise(s, hp).velocities->size();
  CHECK(run::unknowns(s, hp) == (2 * hp.levels + 1) * nodes);
  const auto grouped = hp_resolution(s, 7, 0, 1e-6, {}, {3});
  CHECK(grouped.noise_nodes() < 2 * grouped.levels + 1);
  CHECK(run::unknowns(s, grouped) == grouped.noise_nodes() * nodes);
  CHECK(run::discretise(s, grouped).noise->count() == grouped.noise_nodes());
  const auto exact = run::exact_resolution(s, 1e-6);
  CHECK(run::unknowns(s, exact) == 2 * exact.levels + 1);
}

TEST_CASE("resolution: the work of a band, or of blocks of noise nodes") {
  const auto s = scene(1, 0.25, 1, 0.25);
  const auto hp = hp_resolution(s, 7, 0, 1e-6);
  const double levels = 2.0 * hp.levels + 1;
  const double nodes = run::discretise(s, hp).velocities->size(), n = levels * nodes;
  const double band = n * nodes * std::min(levels, nodes);
  const auto blocks = generator::elimination_cost(run::discretise(s, hp), true, 1);
  CHECK(run::relative_work(s, hp) == Approx(blocks.operations));
  auto both = hp;
  both.branches = 2;
  CHECK(run::relative_work(s, both) == Approx(blocks.operations));  // one serves both
  auto pushed = s;
  pushed.bias = 1e-9;
  CHECK(run::relative_work(pushed, both) == Approx(2 * blocks.operations).epsilon(0.01));
  auto by_mumps = hp;
  by_mumps.factors = cases::Factors::in_memory;
  CHECK(run::relative_work(s, by_mumps) == Approx(band));
  const auto upwind = run::upwind_resolution(s, 2, 1e-6);
  const double all = static_cast<double>(run::unknowns(s, upwind));
  const double rows = 2.0 * upwind.levels + 1;
  CHECK(run::relative_work(s, upwind) == Approx(all * std::min(rows, all / rows)));
  CHECK(run::relative_work(s, run::exact_resolution(s, 1e-6)) ==
        Approx(std::pow(2.0 * run::exact_resolution(s, 1e-6).levels + 1, 3)));
}

TEST_CASE(
    "resolution: the velocity discretisation of the other sign has the drag of the other sign") {
  auto s = scene(1, 0.25, 1, 0.25);
  s.drag = model::parse_drag("-(1 + 0.3*tanh(v))*v", s.friction, 1, 8);
  s.noise_levels = 8;
  for (const auto& resolution :
       {run::upwind_resolution(s, 2, 1e-6), hp_resolution(s, 4, 0, 1e-6)}) {
    const auto velocities = run::discretise(s, resolution).velocities;
    generator::TransportRow upper, lower;
    velocities->transport(0.1, velocities->size() / 2, upper);
    velocities->mirrored().transport(0.1, velocities->size() / 2, lower);
    double up = 0, down = 0;
    for (const auto& e : upper.entries) up += std::abs(e.value);
    for (const auto& e : lower.entries) down += std::abs(e.value);
    CHECK(up > 1.05 * down);  // faster with more drag
  }
}

TEST_CASE("resolution: what the user fixes stays fixed") {
  auto s = scene(1, 0.25, 1, 0.25);
  s.noise_levels = 20;
  CHECK(hp_resolution(s, 5, 0, 1e-12).levels == 20);
  CHECK(hp_resolution(s, 5, 9, 1e-12).layers == 9);
  CHECK(hp_resolution(s, 5, 0, 1e-12).layers > 0);
}

TEST_CASE("resolution: what is cut off is an error, and nothing where nothing is cut") {
  auto s = scene(1, 0.25, 1, 0.25);
  s.drag = {0.01, 0};
  CHECK(hp_resolution(s, 5, 0, 1e-8).truncation == Approx(3e-8));
  s.drag = {1, 0};  // the terminal velocity of the highest level is near
  CHECK(hp_resolution(s, 5, 0, 1e-8).truncation == Approx(3e-8));
  s.noise_levels = 8;
  CHECK(hp_resolution(s, 5, 0, 1e-8).truncation == 0);
  s.drag = {0.01, 0};
  CHECK(hp_resolution(s, 5, 0, 1e-8).truncation == Approx(3e-8));
  s.v_max = 2;  // the error of which is reported
  CHECK(hp_resolution(s, 5, 0, 1e-8).truncation == 0);
}

TEST_CASE("refinement sequence: elements stay where they are, unless the tail counts") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.125);
  given.scene.drag = {0.01, 0};
  given.question.accuracy = 1e-6;
  const auto ends = [&](const run::RefinementSequence& sequence, int n) {
    const auto d = run::discretise(given.scene, sequence.refinement_level(n));
    return std::vector(d.velocities->cells().begin(), d.velocities->cells().end());
  };
  const run::RefinementSequence steady(given);
  for (int n = 0; n <= steady.last(); ++n) {
    CHECK(ends(steady, n) == ends(steady, -1));
    CHECK(steady.refinement_level(n).levels == steady.refinement_level(-1).levels);
  }
  CHECK_FALSE(steady.refinement_level(1).whole_tail);
  const auto further = [&] {
    const run::RefinementSequence sequence(given);
    CHECK(ends(sequence, 0).back() == ends(sequence, -1).back());
    for (int n = 1; n <= 4; ++n) CHECK(ends(sequence, n).back() > ends(sequence, n - 1).back());
    CHECK(sequence.refinement_level(1).whole_tail);
  };
  given.question.quantities = {cases::Quantity::peak};
  further();
  given.question.quantities = {cases::Quantity::relaxation};
  further();
  given.question.quantities = {cases::Quantity::averages};
  given.question.observables.push_back(model::parse_observable("v^8", given.scene.friction));
  further();
}

TEST_CASE("refinement sequence: every level is finer in every respect") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.125);
  given.scene.drag = {0.01, 0};
  const auto quantity = GENERATE(cases::Quantity::sticking, cases::Quantity::entry_law);
  given.question.quantities = {quantity};
  given.question.accuracy = GENERATE(0.1, 1e-8);
  const run::RefinementSequence sequence(given);
  REQUIRE(sequence.first() == -1);
  REQUIRE(sequence.last() > 3);
  const auto nodes_of_smallest = [&](const run::Resolution& r) {
    const auto velocities = run::discretise(given.scene, r).velocities;
    return std::ranges::count_if(velocities->nodes(),
                                 [end = velocities->cells()[1]](double v) { return v <= end; });
  };
  for (int n = sequence.first() + 1; n <= sequence.last(); ++n) {
    const auto coarse = sequence.refinement_level(n - 1), fine = sequence.refinement_level(n);
    CHECK(fine.degree > coarse.degree);
    CHECK(nodes_of_smallest(fine) > nodes_of_smallest(coarse));
    CHECK(fine.levels >= coarse.levels);
    CHECK(fine.v_max >= coarse.v_max);
    CHECK(fine.grouping.degree > coarse.grouping.degree);
    CHECK(sequence.tail_tolerance(n) <= sequence.tail_tolerance(n - 1));
  }
}

TEST_CASE("refinement sequence: what is fixed by hand is compared with two degrees less") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.25);
  given.method.degree = 4;
  const run::RefinementSequence fixed(given);
  CHECK(fixed.first() == -1);
  CHECK(fixed.last() == 1);
  for (int n = -1; n <= 1; ++n) {
    CHECK(fixed.refinement_level(n).degree == 3 + n);
    CHECK(fixed.refinement_level(n).least_degree == 1 + n);
  }
  given.method.degree = 1;
  const run::RefinementSequence lowest(given);
  CHECK(lowest.first() == 0);
  CHECK(lowest.refinement_level(0).degree == 0);
}

TEST_CASE("refinement sequence: first-order schemes are compared with one discretisation") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.25);
  given.method.scheme = cases::Scheme::none;
  CHECK(run::RefinementSequence(given).first() == 0);
  given.method = {.scheme = cases::Scheme::upwind, .points = 1};
  const run::RefinementSequence one_point(given);
  CHECK(one_point.refinement_level(1).points == 1);
  CHECK(one_point.refinement_level(0).points == 2);  // nothing coarser exists
  // u^p = u + C/p: the change C/2 is half the error at p = 1.
  CHECK(one_point.first() == 0);
  CHECK(one_point.error_per_change(1).last >= 2);
}

// Of errors that fall as C/p the estimate is 1.5 to 2 times too large, more where p is small.
TEST_CASE("refinement sequence: first-order changes are extrapolated, with a margin") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.25);
  given.method.scheme = cases::Scheme::upwind;
  const run::RefinementSequence sequence(given);
  for (int n = 1; n < 6; ++n) {
    const double coarse = 1.0 / sequence.refinement_level(n - 1).points,
                 fine = 1.0 / sequence.refinement_level(n).points;
    const double estimate = sequence.error_per_change(n).last * (coarse - fine);
    CHECK(estimate == Approx(1.5 * (1 + 2 * fine) * fine));
  }
  CHECK(sequence.error_per_change(2).earlier == 0);
  CHECK(sequence.first_order());
  CHECK(sequence.last() == 20);
  for (int points : {7, 32}) {
    given.method.points = points;
    const run::RefinementSequence fixed(given);
    const double coarse = 1.0 / fixed.refinement_level(0).points,
                 fine = 1.0 / fixed.refinement_level(1).points;
    CHECK(fixed.error_per_change(1).last * (coarse - fine) == Approx(1.5 * (1 + 2 * fine) * fine));
  }
}

TEST_CASE("refinement sequence: two hp changes make an error, the larger the higher the degree") {
  cases::Case given;
  given.question.quantities = {cases::Quantity::sticking};
  given.scene = scene(1, 0.25, 1, 0.25);
  const run::RefinementSequence sequence(given);
  for (int n = 1; n < 9; ++n) {
    const int degree = std::max(10, sequence.refinement_level(n).degree);
    CHECK(sequence.error_per_change(n).last == Approx(0.07 * degree));
    CHECK(sequence.error_per_change(n).earlier == Approx(0.0035 * degree));
  }
  CHECK_FALSE(sequence.first_order());
  cases::Case levels = given;
  levels.scene.noise.name = "telegraph";
  const std::vector<model::Level> rows{{-1.5, 2, 0}, {0, 1, 3}, {2, 0, 1}};
  levels.scene.noise.table = std::make_shared<const model::LevelTable>(rows);
  const auto of_table = run::RefinementSequence(levels).error_per_change(1);
  CHECK(of_table.earlier == Approx(4 * 0.035));
  CHECK(of_table.of_other_family == 0.6);
  CHECK(sequence.error_per_change(1).of_other_family == 0);
  given.scene.friction_name = "stribeck";
  given.scene.friction.stribeck = model::Stribeck{0.1, 1};
  const run::RefinementSequence weakening(given);
  const int degree = weakening.refinement_level(1).degree;
  REQUIRE(degree + 4 > 10);
  CHECK(weakening.error_per_change(1).last == Approx(0.07 * (degree + 4)));
  given.question.quantities = {cases::Quantity::peak};
  CHECK(run::RefinementSequence(given).error_per_change(1).last ==
        Approx(1.4 * 0.07 * (degree + 4)));
}

TEST_CASE(
    "refinement sequence: the first estimate is expected at the accuracy, within degrees 5 to 19") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.25);
  const auto first = [&](double accuracy, cases::Quantity quantity) {
    given.question.accuracy = accuracy;
    given.question.quantities = {quantity};
    return run::RefinementSequence(given).refinement_level(1).degree;
  };
  // Errors are 10^-d at degree d, and the estimate is that of a degree less; ten times that for
  // densities at 0+, a hundred times for densities of durations; those of path lengths fall slower,
  // on elements on which others fall faster.
  CHECK(first(1e-6, cases::Quantity::sticking) == 7);
  CHECK(first(1e-6, cases::Quantity::entry_law) == 8);
  CHECK(first(1e-6, cases::Quantity::duration_density) == 9);
  CHECK(first(1e-6, cases::Quantity::slip) == 7);
  CHECK(first(1e-6, cases::Quantity::displacement) == 6);
  given.question.distance = {1};
  CHECK(first(1e-6, cases::Quantity::slip) == 9);
  CHECK(first(1e-2, cases::Quantity::slip) == 5);
  given.question.quantities = {cases::Quantity::slip, cases::Quantity::sticking};
  CHECK(run::RefinementSequence(given).refinement_level(1).degree == 5);
  given.question.distance.clear();
  CHECK(first(3e-7, cases::Quantity::sticking) == 8);
  CHECK(first(0.1, cases::Quantity::sticking) == 5);
  CHECK(first(1e-30, cases::Quantity::sticking) == 19);
  given.question.accuracy = 1e-6;
  const run::RefinementSequence sequence(given);
  CHECK(sequence.refinement_level(sequence.last()).degree == 19);
}

TEST_CASE("refinement sequence: truncation is allowed a part of what the discretisation leaves") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.25);
  given.question.accuracy = 1e-6;
  given.question.quantities = {cases::Quantity::entry_law};
  const run::RefinementSequence hp(given);
  for (int n = -1; n < 4; ++n) CHECK(hp.tail_tolerance(n) == Approx(1e-12));
  given.question.quantities = {cases::Quantity::peak};
  const run::RefinementSequence peak(given);
  given.question.quantities = {cases::Quantity::relaxation};
  const run::RefinementSequence modes(given);
  CHECK(peak.tail_tolerance(-1) == peak.tail_tolerance(0));
  for (int n = 0; n < 4; ++n) {
    const double expected = std::pow(10.0, -(peak.refinement_level(n).degree + 4));
    CHECK(peak.tail_tolerance(n) == Approx(expected));
    CHECK(modes.tail_tolerance(n) == Approx(expected * expected));
  }
  given.question.quantities = {cases::Quantity::sticking};
  given.method.scheme = cases::Scheme::upwind;
  CHECK(run::RefinementSequence(given).tail_tolerance(1) == Approx(1e-9));
  given.question.accuracy = 1e-3;
  CHECK(run::RefinementSequence(given).tail_tolerance(3) == Approx(1e-9));
  given.question.accuracy = 1e-8;
  CHECK(run::RefinementSequence(given).tail_tolerance(3) == Approx(1e-11));
  given.method.scheme = cases::Scheme::none;
  CHECK(run::RefinementSequence(given).tail_tolerance(0) == Approx(1e-8));
  CHECK(run::RefinementSequence(given).tail_tolerance(2) == Approx(1e-12));
  CHECK(run::RefinementSequence(given).tail_tolerance(20) == Approx(1e-18));
}

TEST_CASE("refinement sequence: the noise is on nodes, of a degree by hand, or on all levels") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 1.0 / 32);
  given.method.noise_grading = 3;
  const run::RefinementSequence free(given);
  CHECK(2 * free.refinement_level(1).noise_nodes() < 2 * free.refinement_level(1).levels + 1);
  CHECK(free.refinement_level(1).grouping.grading == 3);
  given.method.noise_degree = 0;
  const run::RefinementSequence levels(given);
  CHECK(levels.last() > 1);
  CHECK(levels.refinement_level(1).noise_nodes() == 2 * levels.refinement_level(1).levels + 1);
  given.method.noise_degree = 5;
  const run::RefinementSequence fixed(given);
  CHECK(fixed.last() == 1);
  CHECK(fixed.refinement_level(1).grouping.degree == 5);
  CHECK(fixed.refinement_level(0).grouping.degree == 4);
  given.method.noise_degree.reset();
  // The solution methods of the paper use single levels alone.
  for (auto route : {cases::Route::lambda, cases::Route::hitting, cases::Route::null_vector}) {
    given.method.route = route;
    CHECK_FALSE(run::RefinementSequence(given).refinement_level(1).noise);
  }
  given.method.route = cases::Route::excursion;
  // Modes near the limits of rounding use them as well.
  given.question.quantities = {cases::Quantity::relaxation};
  given.question.accuracy = 1e-8;
  CHECK_FALSE(run::RefinementSequence(given).refinement_level(1).noise);
  given.question.accuracy = 1e-7;
  CHECK(run::RefinementSequence(given).refinement_level(1).noise);
  given.question.quantities = {cases::Quantity::sticking};
  CHECK(run::RefinementSequence(given).refinement_level(1).noise);
  given.method.scheme = cases::Scheme::upwind;
  CHECK_FALSE(run::RefinementSequence(given).refinement_level(1).noise);
}

TEST_CASE("refinement sequence: both signs of v where there is no symmetry, or none is used") {
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.25);
  CHECK(run::RefinementSequence(given).refinement_level(1).branches == 1);
  given.method.route = cases::Route::null_vector;
  CHECK(run::RefinementSequence(given).refinement_level(1).branches == 2);
  given.method.route = cases::Route::excursion;
  given.scene.bias = 0.2;
  CHECK(run::RefinementSequence(given).refinement_level(1).branches == 2);
}

TEST_CASE(
    "refinement sequence: elements resolve the fastest rate of what is asked for, and no other") {
  using enum cases::Quantity;
  cases::Case given;
  given.scene = scene(1, 0.25, 1, 0.25);
  given.question.lambda = {3, 700, 2};
  given.question.omega = {1, 200, 5};
  const auto rates = [&](std::set<cases::Quantity> quantities, int refinement_level = 1) {
    given.question.quantities = std::move(quantities);
    const run::RefinementSequence sequence(given);
    const auto& found = sequence.refinement_level(refinement_level);
    CHECK(found.rates.omega == 0);
    return std::pair{found.rates.lambda, found.waves};
  };
  const std::vector<double> none, waves{200};  // those beyond four times the rate of jumps
  CHECK(rates({sticking}) == std::pair{0.0, none});
  CHECK(rates({laplace}) == std::pair{700.0, none});
  CHECK(rates({resolvent}) == std::pair{700.0, none});
  // Waves only where the first change asks for it, or nothing is refined.
  CHECK(rates({spectrum}) == std::pair{0.0, none});
  CHECK(rates({spectrum}, 2) == std::pair{0.0, waves});
  given.method.degree = 8;
  CHECK(rates({spectrum}) == std::pair{0.0, waves});
  given.method.degree.reset();
  given.method.route = cases::Route::lambda;
  CHECK(rates({sticking}) == std::pair{700.0, none});
}

TEST_CASE("refinement sequence: functions of short times have layers where noise levels are few") {
  using enum cases::Quantity;
  cases::Case given;
  given.scene = scene(1, 0.5, 1, 0.25);
  given.question.time = {0, 3, 0.5};
  given.question.distance = {3, 0.25};
  const auto rate = [&](cases::Quantity quantity) {
    given.question.quantities = {quantity};
    return run::RefinementSequence(given).refinement_level(1).rates.lambda;
  };
  CHECK(rate(duration_density) == 0);
  given.scene.noise.name = "telegraph";
  const std::vector<model::Level> rows{{-1, 1, 0}, {1, 0, 1}};
  given.scene.noise.table = std::make_shared<const model::LevelTable>(rows);
  given.scene.bias = 0.25;
  CHECK(rate(duration_density) == Approx(24));
  // The net force on X = 1 is 1 + bias - mu_d.
  CHECK(rate(slip) == Approx(5 * std::sqrt(12 * 0.75 / 0.25)));
  CHECK(rate(sticking) == 0);
}

// By MUMPS alone, whose count is its own; its analysis is enough for memory, entries come from
// factors.
TEST_CASE("memory: predicted within a factor 2.5 of what MUMPS counts", "[slow]") {
  const test::Given mumps({{"-slide_pc_type", "lu"}});
  struct Case {
    double delta;
    int degree, points;
  };
  for (const auto& c : {Case{0.25, 9, 0}, Case{1.0 / 16, 5, 0}, Case{1.0 / 16, 11, 0},
                        Case{1.0 / 64, 7, 0}, Case{0.25, 0, 128}, Case{1.0 / 16, 0, 16}}) {
    const auto s = scene(1, 0.25, 1, c.delta);
    auto resolution = c.points > 0 ? run::upwind_resolution(s, c.points, 1e-8)
                                   : hp_resolution(s, c.degree, 0, 1e-8);
    resolution.factors = cases::Factors::in_memory;
    cases::Case given;
    given.scene = s;
    given.question.quantities = {cases::Quantity::sticking};
    const auto statistics = run::solve_on(MPI_COMM_WORLD, given, resolution).step.statistics;
    const double predicted = run::predicted_bytes(s, resolution);
    const double scalars = linalg::complex_scalars() ? 2 : 1;
    const double counted = 1e6 * statistics.factor_megabytes +
                           50.0 * scalars * static_cast<double>(statistics.nonzeros);
    INFO("delta " << c.delta << " degree " << c.degree << " p " << c.points);
    CHECK(predicted > counted / 2.5);
    CHECK(predicted < counted * 2.5);
    CHECK(std::abs(static_cast<double>(run::unknowns(s, resolution) - statistics.unknowns)) <
          2.0 * resolution.levels + 2);
  }
}
