#include <catch2/catch.hpp>
#include <set>

#include "stickslip/operators/state_space.hpp"
#include "stickslip/petsc/session.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/velocity/hp_axis.hpp"
#include "stickslip/velocity/upwind_axis.hpp"

using namespace stickslip;
using operators::Half;
using operators::State;
using operators::StateKind;
using operators::StateSpace;
using operators::Symmetry;

namespace {

model::Process process_on(int levels, double mu_s, double mu_d) {
  return {{1, 0.25, levels}, {mu_s, mu_d}, {1, 0}};
}

// Number of states of each kind by counting what the model says exists.
PetscInt expected_size(const model::Process& process, const velocity::Axis& axis, Symmetry symmetry,
                       bool with_rest) {
  const int n = process.noise.levels, k = process.static_index();
  const int halves = symmetry == Symmetry::none ? 2 : 1;
  int size = halves * (2 * n + 1) * axis.size();
  if (axis.keeps_origin()) size += halves * (n - k);
  for (int l = -n; l <= n; ++l) {
    const bool accelerates = process.excess(l) + process.drag(axis.v_max()) > 0;
    if (axis.needs_holding() && accelerates) size += halves;
  }
  if (with_rest) size += symmetry == Symmetry::none ? 2 * k + 1 : (symmetry == Symmetry::even) + k;
  return size;
}

}  // namespace

TEST_CASE("state space: every state has one index, ranks follow one another", "[parallel]") {
  const auto process = process_on(9, 1, 0.25);
  const velocity::HpAxis tall({0, 0.1, 0.5, 8}, 2, process.drag);
  const velocity::HpAxis cut({0, 0.1, 0.5, 1}, 2, process.drag);
  const velocity::UpwindAxis grid(0.05, 40, process.drag);
  for (const velocity::Axis* axis :
       {static_cast<const velocity::Axis*>(&tall), static_cast<const velocity::Axis*>(&cut),
        static_cast<const velocity::Axis*>(&grid)}) {
    for (Symmetry symmetry : {Symmetry::even, Symmetry::odd, Symmetry::none}) {
      for (bool with_rest : {false, true}) {
        const StateSpace states(PETSC_COMM_WORLD, process, *axis, symmetry, with_rest);
        CHECK(states.global_size() == expected_size(process, *axis, symmetry, with_rest));
        PetscInt next = states.local_begin();
        states.for_each_local([&](const State& s) { CHECK(states.index(s) == next++); });
        CHECK(next == states.local_begin() + states.local_size());
        PetscInt total = states.local_size();
        MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD);
        CHECK(total == states.global_size());
      }
    }
  }
}

TEST_CASE("state space: all ranks know the index of every state", "[parallel]") {
  const auto process = process_on(6, 0.6, 0.25);
  const velocity::UpwindAxis axis(0.1, 3, process.drag);
  const StateSpace states(PETSC_COMM_WORLD, process, axis, Symmetry::none, true);
  std::set<PetscInt> seen;
  for (int l = -6; l <= 6; ++l) {
    for (Half half : {Half::upper, Half::lower}) {
      for (int j = 0; j < 3; ++j) seen.insert(states.index({StateKind::node, half, l, j}));
      if (states.has_origin(half, l)) seen.insert(states.index({StateKind::origin, half, l, 0}));
    }
    if (states.has_rest(l)) seen.insert(states.index({StateKind::rest, Half::upper, l, 0}));
  }
  CHECK(static_cast<PetscInt>(seen.size()) == states.global_size());
  CHECK(*seen.begin() == 0);
  CHECK(*seen.rbegin() == states.global_size() - 1);
}

TEST_CASE("state space: a rank owns i together with -i", "[parallel]") {
  const auto process = process_on(9, 1, 0.25);
  const velocity::UpwindAxis axis(0.1, 3, process.drag);
  const StateSpace states(PETSC_COMM_WORLD, process, axis, Symmetry::even, false);
  const auto levels = states.local_levels();
  CHECK(std::is_sorted(levels.begin(), levels.end()));
  for (int i : levels) CHECK(std::binary_search(levels.begin(), levels.end(), -i));
}

TEST_CASE("state space: more ranks than shells leaves some ranks empty", "[parallel]") {
  const auto process = process_on(1, 0.1, 0.1);
  const velocity::UpwindAxis axis(0.1, 2, process.drag);
  const StateSpace states(PETSC_COMM_WORLD, process, axis, Symmetry::even, false);
  CHECK(states.global_size() == 7);  // three levels of two nodes, and the origin of level 1
}

TEST_CASE("state space: too many states are refused before anything is allocated") {
  const auto process = process_on(2000000, 1, 0.25);
  const velocity::UpwindAxis axis(0.001, 2000, process.drag);
  CHECK_THROWS_AS(StateSpace(PETSC_COMM_WORLD, process, axis, Symmetry::even, false), NoMemory);
}

TEST_CASE("state space: with a bias every state has one index, too", "[parallel]") {
  for (double bias : {0.3, -0.55, 1.1}) {
    auto process = process_on(8, 0.6, 0.25);
    process.bias = bias;
    const velocity::UpwindAxis axis(0.1, 3, process.drag);
    const StateSpace states(PETSC_COMM_WORLD, process, axis, Symmetry::none, true);
    PetscInt next = states.local_begin();
    states.for_each_local([&](const State& state) {
      REQUIRE(states.index(state) == next);
      ++next;
    });
    CHECK(next - states.local_begin() == states.local_size());
    PetscInt origins = 0, rests = 0;
    for (int i = -8; i <= 8; ++i) {
      const double force = process.noise.level(i) + bias;
      const bool rest = std::abs(force) <= 0.6 + 1e-12;
      CHECK(states.has_rest(i) == rest);
      rests += rest ? 1 : 0;
      CHECK(states.has_origin(Half::upper, i) == (force > 0.6 + 1e-12));
      CHECK(states.has_origin(Half::lower, -i) == (force < -0.6 - 1e-12));
      origins += rest ? 0 : 1;
    }
    CHECK(states.global_size() == 2 * 17 * 3 + rests + origins);
  }
}
