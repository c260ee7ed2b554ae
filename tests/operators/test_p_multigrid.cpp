#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "../common/options.hpp"
#include "../common/scenes.hpp"
#include "../common/systems.hpp"
#include "stickslip/operators/hierarchy.hpp"
#include "stickslip/operators/systems.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using operators::KolmogorovOperator;
using operators::Rest;
using operators::Symmetry;
using operators::Systems;
using petsc::check;

namespace {

petsc::VecHandle like(Vec x) {
  petsc::VecHandle y;
  check(VecDuplicate(x, y.out()));
  return y;
}

// max |a - b| / max |b|.
double distance(Vec a, Vec b) {
  const petsc::VecHandle difference = like(a);
  PetscReal error = 0, size = 0;
  check(VecWAXPY(difference, -1, a, b));
  check(VecNorm(difference, NORM_INFINITY, &error));
  check(VecNorm(b, NORM_INFINITY, &size));
  return error / size;
}

// to += M from, on the values of each element and level.
void apply(const std::vector<PetscScalar>& m, int rows, int columns, int levels,
           const PetscScalar* from, PetscScalar* to) {
  for (int a = 0; a < levels; ++a) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c)
        to[r * levels + a] += m[r + rows * c] * from[c * levels + a];
    }
  }
}

struct Pair {
  KolmogorovOperator fine, coarse;
  petsc::Hierarchy hierarchy;
};

Pair pair(const test::Discrete& d, Symmetry symmetry, Rest rest) {
  const auto& axis = dynamic_cast<const velocity::HpAxis&>(*d.axis);
  const auto coarse_axis = axis.coarsened(2);
  KolmogorovOperator fine(PETSC_COMM_WORLD, d.process, axis, 0.3, symmetry, rest);
  KolmogorovOperator coarse(PETSC_COMM_WORLD, d.process, *coarse_axis, 0.3, symmetry, rest);
  auto hierarchy = operators::hierarchy(fine.states(), axis, coarse.states(), *coarse_axis);
  return {std::move(fine), std::move(coarse), std::move(hierarchy)};
}

petsc::VecHandle prolonged(const Pair& p, Vec coarse) {
  petsc::VecHandle fine = p.fine.zeros();
  const petsc::ReadView from(coarse);
  petsc::WriteView to(fine);
  for (const auto& strip : p.hierarchy.strips) {
    apply(strip.modes->prolong, strip.modes->nodes, strip.modes->coarse_nodes, p.hierarchy.levels,
          from.data() + strip.coarse_first, to.data() + strip.first);
  }
  for (const auto& [row, coarse_row] : p.hierarchy.others) to[row] = from[coarse_row];
  return fine;
}

petsc::VecHandle restricted(const Pair& p, Vec fine) {
  petsc::VecHandle coarse = p.coarse.zeros();
  const petsc::ReadView from(fine);
  petsc::WriteView to(coarse);
  for (const auto& strip : p.hierarchy.strips) {
    apply(strip.modes->restriction, strip.modes->coarse_nodes, strip.modes->nodes,
          p.hierarchy.levels, from.data() + strip.first, to.data() + strip.coarse_first);
  }
  for (const auto& [row, coarse_row] : p.hierarchy.others) to[coarse_row] = from[row];
  return coarse;
}

}  // namespace

TEST_CASE("p-multigrid: high modes and coarse values are bases dual to each other") {
  const Pair p =
      pair(test::on_hp(test::killed_systems()[0].scene, 6), Symmetry::none, Rest::killing);
  for (const auto& strip : p.hierarchy.strips) {
    const auto& m = *strip.modes;
    const int q = m.nodes, c = m.coarse_nodes, h = m.high();
    double error = 0;
    const auto compare = [&](const auto& left, int rows, const auto& right, int columns,
                             bool same) {
      for (int r = 0; r < rows; ++r) {
        for (int k = 0; k < columns; ++k) {
          PetscScalar sum = 0;
          for (int n = 0; n < q; ++n) sum += left[r + rows * n] * right[n + q * k];
          error = std::max(error, PetscAbsScalar(sum - (same && r == k ? 1.0 : 0.0)));
        }
      }
    };
    compare(m.restriction, c, m.prolong, c, true);
    compare(m.restriction, c, m.from_high, h, false);
    compare(m.to_high, h, m.prolong, c, false);
    compare(m.to_high, h, m.from_high, h, true);
    CHECK(error < 1e-13);
  }
}

// The quadrature of the elements is exact for linear drag.
TEST_CASE("p-multigrid: the operator on lower degrees is the projection of the fine one",
          "[parallel]") {
  for (const auto& [scene, symmetry, rest] : test::killed_systems()) {
    if (!scene.drag.is_linear()) continue;
    const Pair p = pair(test::on_hp(scene, 5), symmetry, rest);
    const auto x = p.coarse.values([](double f, double y, double v) {
      return std::cos(3 * f) + std::sin(f + 2 * v) + 0.2 * y;
    });
    const auto fine = prolonged(p, x);
    const petsc::VecHandle image = like(fine), own = like(x);
    check(MatMult(p.fine.matrix(), fine, image));
    check(MatMult(p.coarse.matrix(), x, own));
    CHECK(distance(restricted(p, image), own) < 1e-12);
  }
}

TEST_CASE("p-multigrid: solves as an elimination does, in few iterations", "[parallel]") {
  for (const auto& [scene, symmetry, rest] : test::killed_systems()) {
    const auto d = test::on_hp(scene, 7, 1e-10);
    petsc::Ledger ledger, direct_ledger;
    Systems systems(PETSC_COMM_WORLD, d.process, d.axis, ledger);
    Systems direct_systems(PETSC_COMM_WORLD, d.process, d.axis, direct_ledger);
    systems.prefer_iteration();
    auto& iterated = systems.at(0.3, symmetry, rest);
    auto& direct = direct_systems.at(0.3, symmetry, rest);
    const auto b = iterated.a().values(
        [](double x, double y, double v) { return 1 + std::sin(x + y) * std::exp(-v * v); });
    INFO("mu_d " << scene.friction.mu_d << ", delta " << scene.delta << ", bias " << scene.bias);
    CHECK(distance(iterated.factors().solve(b).x, direct.factors().solve(b).x) < 1e-11);
    CHECK(distance(iterated.factors().solve_transposed(b).x,
                   direct.factors().solve_transposed(b).x) < 1e-11);
    CHECK(ledger.iterations > 0);
    CHECK(ledger.iterations <= 60);
    CHECK(ledger.factorizations_real + ledger.factorizations_complex == 1);
  }
}

TEST_CASE("p-multigrid: factors are a small part of those of an elimination", "[parallel]") {
  const auto d = test::on_hp(test::scene(1, 0.25, 1, 0.125, {1, 0}), 9);
  petsc::Ledger ledger;
  Systems systems(PETSC_COMM_WORLD, d.process, d.axis, ledger);
  const auto direct = systems.analyse({0, Symmetry::even});
  systems.prefer_iteration();
  const auto iterated = systems.analyse({0, Symmetry::even});
  CHECK(direct.solver == petsc::Solver::levels);
  CHECK(iterated.solver == petsc::Solver::p_multigrid);
  CHECK(iterated.factor_entries < 0.25 * direct.factor_entries);
  CHECK(iterated.operations < 0.25 * direct.operations);
}

TEST_CASE("p-multigrid: an elimination takes its place where it does not converge", "[parallel]") {
  const auto d = test::on_hp(test::killed_systems()[0].scene, 7);
  const auto solved = [&](petsc::Ledger& ledger) {
    Systems systems(PETSC_COMM_WORLD, d.process, d.axis, ledger);
    systems.prefer_iteration();
    auto& system = systems.at(0, Symmetry::even);
    return system.factors().solve_transposed(system.a().trace_at_exit()).x;
  };
  petsc::Ledger ledger;
  const auto x = solved(ledger);
  const test::Given two({{"-slide_ksp_max_it", "2"}});
  SECTION("by default") {
    petsc::Ledger again;
    CHECK(distance(solved(again), x) < 1e-10);
    CHECK(again.factorizations_real + again.factorizations_complex == 2);
  }
  SECTION("but not where it was asked for") {
    const test::Given asked({{"-slide_pc_type", "p_multigrid"}});
    petsc::Ledger again;
    CHECK_THROWS_AS(solved(again), NotReached);
  }
}

TEST_CASE("p-multigrid: higher degrees take the coarse system of lower ones", "[parallel]") {
  for (const auto& [scene, symmetry, rest] : test::killed_systems()) {
    const auto d = test::on_two_degrees(scene, 6, 7);
    const operators::SystemKey key{0.3, symmetry, rest};
    petsc::Ledger ledger;
    Systems lower(PETSC_COMM_WORLD, d.coarse.process, d.coarse.axis, ledger),
        higher(PETSC_COMM_WORLD, d.fine.process, d.fine.axis, ledger),
        alone(PETSC_COMM_WORLD, d.fine.process, d.fine.axis, ledger);
    for (Systems* systems : {&lower, &higher, &alone}) systems->prefer_iteration();
    const auto solved = [&key](Systems& systems) {
      auto& system = systems.at(key.lambda, key.symmetry, key.rest);
      return system.factors().solve(system.a().values([](double, double, double) { return 1; })).x;
    };
    solved(lower);
    auto coarse = lower.at(key.lambda, key.symmetry, key.rest).coarse();
    const auto* shared = coarse.get();
    const std::weak_ptr<operators::CoarseSystem> alive = coarse;
    lower.release(key.lambda, key.symmetry, key.rest);
    higher.offer(std::move(coarse));
    CHECK(distance(solved(higher), solved(alone)) < 1e-12);
    CHECK(higher.at(key.lambda, key.symmetry, key.rest).coarse().get() == shared);
    CHECK(alive.lock().get() == shared);
    higher.release(key.lambda, key.symmetry, key.rest);
    CHECK(alive.expired());
  }
}

TEST_CASE("p-multigrid: a coarse system of other elements or another key is not taken") {
  const auto scene = test::killed_systems()[0].scene;
  const auto d = test::on_hp(scene, 7), longer = test::on_hp(scene, 7, 1e-6);
  const operators::SystemKey key{0.3, Symmetry::even, Rest::killing};
  petsc::Ledger ledger;
  const auto offered = [&](const test::Discrete& of, double lambda) {
    Systems systems(PETSC_COMM_WORLD, of.process, of.axis, ledger);
    systems.prefer_iteration();
    return systems.at(lambda, key.symmetry, key.rest).coarse();
  };
  for (const auto& other : {offered(longer, key.lambda), offered(d, 0.4)}) {
    REQUIRE(other != nullptr);
    Systems systems(PETSC_COMM_WORLD, d.process, d.axis, ledger);
    systems.prefer_iteration();
    systems.offer(other);
    const auto own = systems.at(key.lambda, key.symmetry, key.rest).coarse();
    CHECK(own != nullptr);
    CHECK(own != other);
  }
}

TEST_CASE("p-multigrid: is refused without elements") {
  const test::Given asked({{"-slide_pc_type", "p_multigrid"}});
  const auto d = test::on_upwind(test::killed_systems()[0].scene, 4);
  petsc::Ledger ledger;
  Systems systems(PETSC_COMM_WORLD, d.process, d.axis, ledger);
  CHECK_THROWS_AS(systems.at(0, Symmetry::even), BadInput);
}
