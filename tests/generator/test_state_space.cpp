#include <set>

#include "../common/catch.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/generator/state_space.hpp"
#include "stickslip/generator/velocity_methods.hpp"
#include "stickslip/linalg/session.hpp"

using namespace stickslip;
using generator::Branch;
using generator::Discretisation;
using generator::State;
using generator::StateKind;
using generator::StateSpace;
using generator::Symmetry;

namespace {

model::Process process_on(int levels, double mu_s, double mu_d) {
  return {{1, 0.25, levels}, {mu_s, mu_d}, {1, 0}};
}

// Number of states of each kind by counting what the model says exists.
PetscInt expected_size(const Discretisation& d, Symmetry symmetry, bool with_static_states) {
  const auto& [process, noise, velocities] = d;
  const int k = process.highest_static();
  const int branches = symmetry == Symmetry::none ? 2 : 1;
  int size = branches * noise->count() * velocities->size();
  if (velocities->keeps_origin()) size += branches * (noise->last() - k);
  for (int n = noise->first(); n <= noise->last(); ++n) {
    const bool accelerates =
        process.net_force_at(noise->x(n)) + process.drag(velocities->v_max()) > 0;
    if (velocities->needs_holding() && accelerates) size += branches;
  }
  if (with_static_states)
    size += symmetry == Symmetry::none ? 2 * k + 1 : (symmetry == Symmetry::even) + k;
  return size;
}

}  // namespace

TEST_CASE("state space: every state has one index, ranks follow one another", "[parallel]") {
  const auto process = process_on(14, 1, 0.25);
  const std::vector<double> low{0, 0.1, 0.5, 1}, high{0, 0.1, 0.5, 8};
  const auto tall = std::make_shared<generator::HpDiscretisation>(high, 2, process.drag);
  const auto truncated = std::make_shared<generator::HpDiscretisation>(low, 2, process.drag);
  const auto grid = std::make_shared<generator::UpwindDiscretisation>(0.05, 40, process.drag);
  const auto nodes = std::make_shared<generator::Nodes>(process, generator::Grouping{1, 50});
  REQUIRE(nodes->last() < 14);
  for (const Discretisation& d :
       {Discretisation(process, tall), Discretisation(process, truncated),
        Discretisation(process, grid), Discretisation(process, tall, nodes),
        Discretisation(process, truncated, nodes)}) {
    for (Symmetry symmetry : {Symmetry::even, Symmetry::odd, Symmetry::none}) {
      for (bool with_static_states : {false, true}) {
        const StateSpace states(PETSC_COMM_WORLD, d, symmetry, with_static_states);
        CHECK(states.global_size() == expected_size(d, symmetry, with_static_states));
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
  const auto velocities = std::make_shared<generator::UpwindDiscretisation>(0.1, 3, process.drag);
  const StateSpace states(PETSC_COMM_WORLD, {process, velocities}, Symmetry::none, true);
  std::set<PetscInt> seen;
  for (int l = -6; l <= 6; ++l) {
    for (Branch branch : {Branch::positive, Branch::negative}) {
      for (int j = 0; j < 3; ++j) seen.insert(states.index({StateKind::node, branch, l, j}));
      if (states.has_origin(branch, l))
        seen.insert(states.index({StateKind::origin, branch, l, 0}));
    }
    if (states.has_static_state(l))
      seen.insert(states.index({StateKind::static_phase, Branch::positive, l, 0}));
  }
  CHECK(static_cast<PetscInt>(seen.size()) == states.global_size());
  CHECK(*seen.begin() == 0);
  CHECK(*seen.rbegin() == states.global_size() - 1);
}

TEST_CASE("state space: a rank owns i together with -i", "[parallel]") {
  const auto process = process_on(9, 1, 0.25);
  const auto velocities = std::make_shared<generator::UpwindDiscretisation>(0.1, 3, process.drag);
  const StateSpace states(PETSC_COMM_WORLD, {process, velocities}, Symmetry::even, false);
  const auto& levels = states.local_noise();
  CHECK(std::is_sorted(levels.begin(), levels.end()));
  for (int i : levels) CHECK(std::binary_search(levels.begin(), levels.end(), -i));
}

TEST_CASE("state space: more ranks than level pairs leaves some ranks empty", "[parallel]") {
  const auto process = process_on(1, 0.1, 0.1);
  const auto velocities = std::make_shared<generator::UpwindDiscretisation>(0.1, 2, process.drag);
  const StateSpace states(PETSC_COMM_WORLD, {process, velocities}, Symmetry::even, false);
  CHECK(states.global_size() == 7);  // three levels of two nodes, and the origin of level 1
}

TEST_CASE("state space: too many states are refused before anything is allocated") {
  const auto process = process_on(200000, 1, 0.25);
  const auto velocities =
      std::make_shared<generator::UpwindDiscretisation>(0.001, 20000, process.drag);
  CHECK_THROWS_AS(StateSpace(PETSC_COMM_WORLD, {process, velocities}, Symmetry::even, false),
                  NoMemory);
}

TEST_CASE("state space: with a bias every state has one index, too", "[parallel]") {
  for (double bias : {0.3, -0.55, 1.1}) {
    auto process = process_on(8, 0.6, 0.25);
    process.bias = bias;
    const auto velocities = std::make_shared<generator::UpwindDiscretisation>(0.1, 3, process.drag);
    const StateSpace states(PETSC_COMM_WORLD, {process, velocities}, Symmetry::none, true);
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
      CHECK(states.has_static_state(i) == rest);
      rests += rest ? 1 : 0;
      CHECK(states.has_origin(Branch::positive, i) == (force > 0.6 + 1e-12));
      CHECK(states.has_origin(Branch::negative, -i) == (force < -0.6 - 1e-12));
      origins += rest ? 0 : 1;
    }
    CHECK(states.global_size() == 2 * 17 * 3 + rests + origins);
  }
}
