#include <petscksp.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "../common/catch.hpp"
#include "../common/options.hpp"
#include "../common/scenes.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/generator/resolvents.hpp"
#include "stickslip/generator/solver_policy.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/linalg/solver.hpp"
#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using cases::Factors;
using cases::Scheme;
using generator::KolmogorovOperator;
using generator::StaticPhase;
using generator::Symmetry;
using linalg::check;

namespace {

model::Scene with_step(double delta) { return test::scene(1, 0.25, 1, delta, {1, 0}); }

KolmogorovOperator sliding(const generator::Discretisation& on, double lambda = 0) {
  return {PETSC_COMM_WORLD, on, lambda, Symmetry::even, StaticPhase::killing};
}

// The solution of (lambda - L) u = 1 by what the options choose, and the type of its PC.
std::pair<linalg::VecHandle, std::string> solved(const generator::Discretisation& on) {
  const auto a = sliding(on, 0.4);
  const auto ksp = linalg::linear_solver(a.matrix(), "user_", generator::default_pc_type(on));
  auto one = a.zeros(), u = a.zeros();
  check(VecSet(one, 1));
  check(KSPSolve(ksp, one, u));
  PC pc = nullptr;
  PCType type = nullptr;
  check(KSPGetPC(ksp, &pc));
  check(PCGetType(pc, &type));
  return {std::move(u), type};
}

double distance(Vec a, Vec b) {
  PetscReal size = 0;
  check(VecAXPY(a, -1, b));
  check(VecNorm(a, NORM_INFINITY, &size));
  return size;
}

}  // namespace

TEST_CASE("solver policy: elements where few noise nodes stand for the levels", "[parallel]") {
  CHECK(generator::chosen_factors(Factors::own, Scheme::hp, 100000, false, true) ==
        Factors::elements);
  CHECK(generator::chosen_factors(Factors::own, Scheme::hp, 700, true, true) == Factors::elements);
  CHECK(generator::chosen_factors(Factors::own, Scheme::hp, 701, true, true) == Factors::in_memory);
  CHECK(generator::chosen_factors(Factors::own, Scheme::upwind, 9, true, true) ==
        Factors::in_memory);
  CHECK(generator::chosen_factors(Factors::on_disk, Scheme::hp, 9, false, true) ==
        Factors::on_disk);
  CHECK(generator::chosen_factors(Factors::own, Scheme::hp, 1500, true, false) ==
        Factors::elements);
  const std::string own = linalg::kElementsPc;
  CHECK(generator::default_pc_type(test::on_nodes(with_step(1.0 / 64), 3, 3)) == own);
  CHECK(generator::default_pc_type(test::on_hp(with_step(1.0 / 64), 2)) == std::string("lu"));
  CHECK(generator::default_pc_type(test::on_upwind(with_step(0.25), 2)) == std::string("lu"));
}

TEST_CASE("solver policy: options choose another solver, with the same solution", "[parallel]") {
  const auto on = test::on_nodes(with_step(0.25), 4, 3);
  const auto [expected, type] = solved(on);
  CHECK(type == linalg::kElementsPc);
  using Options = std::vector<std::pair<std::string, std::string>>;
  const bool alone = linalg::ranks(PETSC_COMM_WORLD) == 1;
  const std::string block = alone ? "ilu" : "bjacobi";
  const std::vector<std::pair<Options, std::string>> choices{
      {{{"-user_pc_type", "lu"}}, "lu"},
      {{{"-user_mat_mumps_icntl_7", "0"}}, "lu"},
      {{{"-user_pc_elements_share", "no"}}, linalg::kElementsPc},
      {{{"-user_pc_type", "redundant"}, {"-user_redundant_pc_factor_mat_solver_type", "klu"}},
       "redundant"},
      {{{"-user_ksp_type", "gmres"}, {"-user_ksp_rtol", "1e-13"}, {"-user_pc_type", block}}, block},
      {{{"-user_ksp_type", "fgmres"}, {"-user_ksp_rtol", "1e-13"}}, linalg::kElementsPc},
      {{{"-user_ksp_type", "gmres"}, {"-user_ksp_rtol", "1e-13"}, {"-user_pc_type", "asm"}},
       "asm"}};
  for (const auto& [options, chosen] : choices) {
    INFO(options.back().first << " " << options.back().second);
    const test::Given given(options);
    const auto [u, used] = solved(on);
    CHECK(used == chosen);
    CHECK(distance(u, expected) < 1e-10);
  }
}

TEST_CASE("PC elements: its view shows what it works on", "[parallel]") {
  const auto on = test::on_nodes(with_step(0.25), 4, 3);
  const auto a = sliding(on);
  const auto ksp = linalg::linear_solver(a.matrix(), "user_", linalg::kElementsPc);
  check(KSPSetUp(ksp));
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* const memory = open_memstream(&text, &size);
  PetscViewer viewer = nullptr;
  check(PetscViewerASCIIOpenWithFILE(PETSC_COMM_WORLD, memory, &viewer));
  check(KSPView(ksp, viewer));
  check(PetscViewerDestroy(&viewer));
  std::fclose(memory);
  const std::string shown(text, size);
  std::free(text);
  if (linalg::rank(PETSC_COMM_WORLD) != 0) return;
  CHECK_THAT(shown, Catch::Contains("type: elements"));
  CHECK_THAT(shown, Catch::Contains("noise nodes " + std::to_string(on.noise->count())));
}

TEST_CASE("PC elements: a matrix of something else is refused", "[parallel]") {
  const auto upwind = sliding(test::on_upwind(with_step(0.25), 2));
  const auto ksp = linalg::linear_solver(upwind.matrix(), "user_", linalg::kElementsPc);
  CHECK_THROWS_AS(check(KSPSetUp(ksp)), BadInput);
}

TEST_CASE("PC elements: shows its events", "[parallel]") {
  const auto on = test::on_nodes(with_step(0.25), 4, 3);
  const linalg::EventTimer set_up("PCElementsSetUp"), solve("PCElementsSolve");
  (void)solved(on);
  CHECK(set_up.seconds() > 0);
  CHECK(solve.seconds() > 0);
}
