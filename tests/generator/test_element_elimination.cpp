#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "../common/catch.hpp"
#include "../common/chains.hpp"
#include "../common/scenes.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/generator/element_elimination.hpp"
#include "stickslip/generator/generator.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/model/drag.hpp"

using namespace stickslip;
using generator::Clock;
using ElementElimination = generator::ElementElimination<PetscScalar>;
using generator::KolmogorovOperator;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;

namespace {

struct Case {
  std::string name;
  generator::Discretisation on;
  Symmetry symmetry;
};

model::Scene plain(double mu_d, double delta) { return test::scene(1, mu_d, 1, delta, {1, 0}); }

// With holding states and without, on levels and on nodes, drags of both kinds, one static level.
std::vector<Case> samples() {
  auto truncated = plain(0.25, 0.25), biased = plain(0.6, 0.2), driven = plain(0.5, 0.25);
  truncated.v_max = 1;
  biased.bias = 0.3;
  driven.bias = -1.4;
  auto one_sided = plain(0.3, 0.25);
  one_sided.noise_levels = 30;
  one_sided.drag = model::parse_drag("-(1 + 0.3*tanh(v))*v", one_sided.friction, 0.25, 30);
  const auto single = test::scene(0.1, 0.1, 1, 0.25, {1, 0});
  const auto free = test::scene(1, 0.5, 1, 0.25, {0, 0});
  std::vector<Case> all;
  for (Symmetry symmetry : {Symmetry::even, Symmetry::odd, Symmetry::none}) {
    all.push_back({"levels", test::on_hp(plain(0.25, 0.25), 4), symmetry});
    all.push_back({"nodes", test::on_nodes(plain(0.25, 1.0 / 16), 4, 3), symmetry});
    all.push_back({"truncated", test::on_nodes(truncated, 3, 2), symmetry});
    all.push_back({"free", test::on_nodes(free, 3, 3), symmetry});
    all.push_back({"one static level", test::on_hp(single, 3), symmetry});
  }
  all.push_back({"bias", test::on_nodes(biased, 4, 2), Symmetry::none});
  all.push_back({"nothing rests long", test::on_nodes(driven, 3, 2), Symmetry::none});
  all.push_back({"five states",
                 test::on_hp(test::with_table(plain(0.5, 1), test::five_states()), 4),
                 Symmetry::none});
  // In the mirror the same, with a level at 0 and without.
  const std::vector<model::Level> four{
      {-2.4, 1, 0}, {-0.8, 0.5, 0.6}, {0.8, 0.6, 0.5}, {2.4, 0, 1}};
  all.push_back({"four levels",
                 test::on_hp(test::with_table(plain(0.5, 1), model::LevelTable(four)), 4),
                 Symmetry::none});
  all.push_back(
      {"sine and levels, alike",
       test::on_hp(
           test::with_table(plain(0.6, 1), test::sine_and_levels(1.2, 4, 6, 0.5, 1, 0.7, 2)), 3),
       Symmetry::none});
  auto shaken = test::with_table(plain(0.6, 1), test::sine_and_levels(1.2, 4, 6, 0.5, 1, 0.7, 2));
  shaken.bias = 0.1;
  all.push_back({"sine and levels", test::on_hp(shaken, 3), Symmetry::none});
  all.push_back({"drag that is not odd", test::on_nodes(one_sided, 3, 2), Symmetry::none});
  return all;
}

linalg::VecHandle rough(const KolmogorovOperator& a) {
  linalg::VecHandle x = a.zeros();
  linalg::WriteView local(x);
  for (PetscInt r = 0; r < a.states().local_size(); ++r) {
    local[r] = 1 + std::sin(1.7 * r * r);
#if defined(PETSC_USE_COMPLEX)
    local[r] += PetscScalar(0, std::cos(2.3 * r));
#endif
  }
  return x;
}

// Largest component of b - A x against those of |A| |x|.
double residual(Mat a, Vec x, Vec b, bool transposed) {
  linalg::VecHandle r;
  check(VecDuplicate(b, r.out()));
  check(transposed ? MatMultTranspose(a, x, r) : MatMult(a, x, r));
  PetscReal size = 0, left = 0;
  check(VecNorm(r, NORM_INFINITY, &size));
  check(VecAXPY(r, -1, b));
  check(VecNorm(r, NORM_INFINITY, &left));
  PetscReal solution = 0, matrix = 0;
  check(VecNorm(x, NORM_INFINITY, &solution));
  check(MatNorm(a, transposed ? NORM_1 : NORM_INFINITY, &matrix));
  return left / (size + matrix * solution);
}

// A rough vector, a zero one, and one that is not zero in the first of its rows alone.
void check_solves(const KolmogorovOperator& a, Mat matrix, bool share = true) {
  const ElementElimination elimination(matrix, generator::data_of(matrix), share);
  std::vector<linalg::VecHandle> given;
  for (int c = 0; c < 3; ++c) given.push_back(c == 0 ? rough(a) : a.zeros());
  check(VecSetValue(given[2], 0, 1, INSERT_VALUES));
  check(VecAssemblyBegin(given[2]));
  check(VecAssemblyEnd(given[2]));
  const auto x = a.zeros();
  const linalg::WholeVectors vectors(matrix);
  for (bool transposed : {false, true}) {
    INFO((transposed ? "transposed" : "forward"));
    linalg::DenseMatrix all(a.states().global_size(), 3);
    for (int c = 0; c < 3; ++c) {
      const auto column = vectors.gathered(given[c]);
      std::copy(column.begin(), column.end(), all.column(c));
    }
    elimination.solve(all, transposed);
    for (int c = 0; c < 3; ++c) {
      INFO("column " << c);
      vectors.scatter(all.column(c), x, [](PetscScalar entry) { return entry; });
      if (c == 1) {
        PetscReal size = 1;
        check(VecNorm(x, NORM_INFINITY, &size));
        CHECK(size == 0);
      } else {
        CHECK(residual(matrix, x, given[c], transposed) < 1e-13);
      }
    }
  }
}

void check_solves(const KolmogorovOperator& a, bool share = true) {
  check_solves(a, a.matrix(), share);
}

}  // namespace

TEST_CASE("element elimination: solves every kind of system, forward and transposed",
          "[parallel]") {
  for (const auto& c : samples()) {
    for (StaticPhase static_phase : {StaticPhase::killing, StaticPhase::kept,
                                     StaticPhase::killed_on_exit, StaticPhase::killing_edges}) {
      INFO(c.name << ", symmetry " << static_cast<int>(c.symmetry) << ", static phase "
                  << static_cast<int>(static_phase));
      const KolmogorovOperator a(PETSC_COMM_WORLD, c.on, 0.4, c.symmetry, static_phase);
      for (bool share : {true, false}) check_solves(a, share);
    }
  }
}

TEST_CASE("element elimination: by the clock of path length, and killed at a speed", "[parallel]") {
  for (const auto& c : samples()) {
    INFO(c.name << ", symmetry " << static_cast<int>(c.symmetry));
    const KolmogorovOperator slow(PETSC_COMM_WORLD, c.on, {3, Clock::path_length}, c.symmetry,
                                  StaticPhase::killing);
    check_solves(slow);
    for (double speed : {0.01, 0.4}) {
      for (StaticPhase static_phase : {StaticPhase::killing, StaticPhase::kept}) {
        const auto below = c.on.cut_at(speed, false, model::Passage::both);
        check_solves({PETSC_COMM_WORLD, below, 0, c.symmetry, static_phase});
      }
    }
  }
}

TEST_CASE("element elimination: with a weight of path and displacement", "[parallel]") {
  for (const auto& c : samples()) {
    if (c.symmetry != Symmetry::none) continue;
    INFO(c.name);
    for (StaticPhase static_phase : {StaticPhase::killing, StaticPhase::kept}) {
      check_solves({PETSC_COMM_WORLD, c.on, {2.0, 0.5, -0.3}, c.symmetry, static_phase});
      check_solves({PETSC_COMM_WORLD, c.on, {9.0, 0.0, 0.7}, c.symmetry, static_phase});
    }
  }
}

TEST_CASE("element elimination: follows a shift of the operator", "[parallel]") {
  PetscScalar shift = 3.5;
#if defined(PETSC_USE_COMPLEX)
  shift = PetscScalar(0.5, 12);
#endif
  for (const auto& c : samples()) {
    INFO(c.name);
    const KolmogorovOperator a(PETSC_COMM_WORLD, c.on, 0.1, c.symmetry, StaticPhase::kept);
    check_solves(a, a.shifted(shift));
  }
}

TEST_CASE("element elimination: solutions found together are those found alone", "[parallel]") {
  for (const auto& c : samples()) {
    INFO(c.name << ", symmetry " << static_cast<int>(c.symmetry));
    linalg::SolverStatistics statistics;
    generator::System system({PETSC_COMM_WORLD, c.on, 0.3, c.symmetry, StaticPhase::kept},
                             statistics);
    const auto& a = system.a();
    std::vector<linalg::VecHandle> b;
    b.push_back(rough(a));
    b.push_back(a.zeros());
    b.push_back(a.values([](double, double y, double v) { return y + v; }));
    const auto together = system.factors().solve_transposed(b);
    CHECK(statistics.solves == 3);
    for (std::size_t n = 0; n < b.size(); ++n) {
      const auto alone = system.factors().solve_transposed(b[n]);
      PetscReal size = 0, difference = 0;
      check(VecNorm(alone.x, NORM_1, &size));
      check(VecAXPY(alone.x, -1, together[n].x));
      check(VecNorm(alone.x, NORM_1, &difference));
      CHECK(difference <= 1e-12 * size);
      CHECK(together[n].backward_error < 1e-14);
    }
  }
}

TEST_CASE("element elimination: what is kept was predicted", "[parallel]") {
  auto pushed = plain(0.25, 1.0 / 64);
  pushed.bias = 0.01;
  const auto alike = test::on_nodes(plain(0.25, 1.0 / 64), 8, 6);
  for (const Case& c :
       {Case{"one branch", alike, Symmetry::even}, Case{"factors for both", alike, Symmetry::none},
        Case{"both", test::on_nodes(pushed, 8, 6), Symmetry::none}}) {
    INFO(c.name);
    const auto& on = c.on;
    const KolmogorovOperator a(PETSC_COMM_WORLD, on, 0.0, c.symmetry, StaticPhase::killing);
    const ElementElimination elimination(a.matrix(), generator::data_of(a.matrix()));
    const int ranks = linalg::ranks(PETSC_COMM_WORLD);
    double kept = elimination.entries();
    MPI_Allreduce(MPI_IN_PLACE, &kept, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    const auto cost = generator::elimination_cost(on, a.states().symmetry_reduced(), ranks);
    const double noise = on.noise->count(), meeting = ranks * noise * noise;  // at v = 0
    CHECK(cost.entries < kept);
    CHECK(cost.entries > 0.97 * kept - meeting);  // and couplings of groups
    CHECK(cost.bytes == sizeof(PetscScalar) * cost.entries);
    const double elements = static_cast<double>(on.velocities->cells().size()) - 1;
    CHECK(cost.operations > elements * noise * noise * noise / 2);
  }
}
