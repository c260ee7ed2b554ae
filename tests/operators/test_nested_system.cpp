#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "../common/options.hpp"
#include "../common/scenes.hpp"
#include "stickslip/operators/hierarchy.hpp"
#include "stickslip/operators/nested_system.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/quantities/stationary.hpp"

using namespace stickslip;
using operators::NestedSystem;
using operators::Systems;
using petsc::check;
using quantities::StationaryLaw;

namespace {

std::vector<model::Scene> scenes() {
  auto biased = test::scene(1, 0.25, 1, 0.25, {1, 0});
  biased.bias = 0.4;
  return {test::scene(1, 0.25, 1, 0.25, {1, 0}),     test::scene(1, 1, 1, 0.125, {1, 0}),
          test::scene(1, 0.3, 0.0625, 0.25, {1, 0}), test::scene(0.5, 0.2, 2, 0.25, {0.2, 1}),
          test::scene(1, 0.5, 1, 0.25, {0, 0}),      biased};
}

double norm(Vec x) {
  PetscReal size = 0;
  check(VecNorm(x, NORM_1, &size));
  return size;
}

petsc::VecHandle difference(Vec a, Vec b) {
  petsc::VecHandle d;
  check(VecDuplicate(a, d.out()));
  check(VecWAXPY(d, -1, a, b));
  return d;
}

std::vector<double> means(const StationaryLaw& law, const quantities::Excursion& excursion) {
  quantities::Results results;
  quantities::append_sticking(excursion, results);
  quantities::append_moments(law.process(), excursion, results);
  std::vector<double> values;
  for (const auto& r : results) {
    if (r.key != "E_V") values.push_back(r.value[0]);
  }
  return values;
}

std::vector<double> means(const StationaryLaw& law) { return means(law, law.excursion()); }

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    largest = std::max(largest, std::abs(a[n] - b[n]) / std::abs(b[n]));
  }
  return largest;
}

}  // namespace

TEST_CASE("nested system: two cycles leave little, and less than the last one changed",
          "[parallel]") {
  for (const auto& scene : scenes()) {
    for (int low : {3, 5, 8}) {
      INFO("mu_d " << scene.friction.mu_d << ", tau " << scene.tau << ", degree " << low);
      const auto d = test::on_two_degrees(scene, low, low + 1);
      petsc::Ledger ledger, nested_ledger;
      Systems coarse(PETSC_COMM_WORLD, d.coarse.process, d.coarse.axis, ledger);
      Systems fine(PETSC_COMM_WORLD, d.fine.process, d.fine.axis, ledger);
      const auto symmetry = operators::symmetry_of(d.fine.process);
      auto& below = coarse.at(0, symmetry);
      auto& direct = fine.at(0, symmetry);
      NestedSystem nested(coarse, d.fine.axis, nested_ledger);
      const auto guess = below.factors().solve_transposed(below.a().trace_at_exit());
      const auto g = nested.a().trace_at_exit();
      const auto exact = direct.factors().solve_transposed(g);
      petsc::VecHandle start = nested.a().zeros();
      petsc::prolong(operators::hierarchy(nested.a().states(), *d.fine.axis, below.a().states(),
                                          *d.coarse.axis),
                     guess.x, start, true);
      const auto found = nested.solve_transposed(g, start);
      const double left = norm(difference(found.x, exact.x));
      CHECK(left < 0.2 * norm(difference(start, exact.x)));
      CHECK(left < norm(found.correction));
      CHECK(nested_ledger.factorizations_real + nested_ledger.factorizations_complex == 0);
      CHECK(nested_ledger.assemblies == 1);
      CHECK(nested_ledger.corrections == 2);
      CHECK(found.backward_error > 0);
      CHECK(nested_ledger.backward_error == found.backward_error);
    }
  }
}

TEST_CASE("nested system: the last cycle shows what is left in means", "[parallel]") {
  for (const auto& scene : scenes()) {
    for (int low : {4, 7}) {
      INFO("mu_d " << scene.friction.mu_d << ", tau " << scene.tau << ", degree " << low);
      const auto d = test::on_two_degrees(scene, low, low + 1);
      petsc::Ledger ledger;
      Systems coarse(PETSC_COMM_WORLD, d.coarse.process, d.coarse.axis, ledger);
      Systems fine(PETSC_COMM_WORLD, d.fine.process, d.fine.axis, ledger);
      const StationaryLaw before(coarse);
      NestedSystem nested(coarse, d.fine.axis, ledger);
      const StationaryLaw found(nested, before);
      const auto exact = means(StationaryLaw(fine));
      const double last = distance(means(found, found.uncorrected()), means(found));
      CHECK(distance(means(found), exact) < last + 0.2 * distance(means(before), exact));
    }
  }
}

TEST_CASE("nested system: an iteration starts from the law on lower degrees", "[parallel]") {
  // The fewer digits, the larger the share that a guess has already.
  const test::Given residual({{"-slide_ksp_rtol", "1e-11"}});
  for (const auto& scene : {scenes()[0], scenes()[5]}) {
    const auto d = test::on_two_degrees(scene, 6, 7);
    petsc::Ledger ledger, cold, warm;
    Systems coarse(PETSC_COMM_WORLD, d.coarse.process, d.coarse.axis, ledger);
    Systems fine(PETSC_COMM_WORLD, d.fine.process, d.fine.axis, cold);
    Systems again(PETSC_COMM_WORLD, d.fine.process, d.fine.axis, warm);
    for (Systems* systems : {&coarse, &fine, &again}) systems->prefer_iteration();
    const StationaryLaw before(coarse);
    const StationaryLaw direct(fine), found(again, &before);
    CHECK(distance(means(found), means(direct)) < 1e-11);
    CHECK(warm.iterations < 0.8 * cold.iterations);
  }
}
