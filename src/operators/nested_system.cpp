#include "stickslip/operators/nested_system.hpp"

#include <algorithm>
#include <utility>

#include "stickslip/operators/hierarchy.hpp"
#include "stickslip/petsc/check.hpp"

namespace stickslip::operators {
namespace {

constexpr int kCycles = 2;

}  // namespace

NestedSystem::NestedSystem(const model::Process& process,
                           std::shared_ptr<const velocity::HpAxis> axis, System& coarse,
                           const velocity::HpAxis& coarse_axis, petsc::Ledger& ledger)
    : process_(process),
      axis_(std::move(axis)),
      coarse_(coarse),
      ledger_(ledger),
      a_(assemble(coarse.a().states().comm(), process, *axis_, 0, coarse.a().states().symmetry(),
                  Rest::killing, ledger)),
      high_(a_.matrix(), hierarchy(a_.states(), *axis_, coarse.a().states(), coarse_axis)),
      measure_(a_.matrix()) {
  const petsc::PhaseTimer timer("factorisation", ledger.factorization_seconds);
  high_.factor();
}

petsc::Solution NestedSystem::solve_transposed(Vec g, Vec guess) {
  const petsc::PhaseTimer timer("solve", ledger_.solve_seconds);
  petsc::Solution s{a_.zeros(), a_.zeros()};
  const petsc::VecHandle residual = a_.zeros(), fine_step = a_.zeros(), step = coarse_.a().zeros(),
                         right = coarse_.a().zeros();
  const auto add_high_modes = [&] {
    compute_residual(g, s.x, residual);
    high_.add(residual, s.x, true);
  };
  petsc::check(VecCopy(guess, s.x));
  add_high_modes();
  for (int n = 0; n < kCycles; ++n) {
    petsc::check(VecCopy(s.x, s.correction));
    compute_residual(g, s.x, residual);
    petsc::restrict_to_coarse(high_.hierarchy(), residual, right, true);
    coarse_.factors().precondition(right, step, true);
    petsc::prolong(high_.hierarchy(), step, fine_step, true);
    petsc::check(VecAXPY(s.x, 1, fine_step));
    add_high_modes();
    petsc::check(VecAYPX(s.correction, -1, s.x));
    ++ledger_.corrections;
  }
  compute_residual(g, s.x, residual);
  s.backward_error = measure_.transposed(residual, g, s.x);
  ledger_.backward_error = std::max(ledger_.backward_error, s.backward_error);
  return s;
}

void NestedSystem::compute_residual(Vec g, Vec nu, Vec residual) const {
  petsc::check(MatMultTranspose(a_.matrix(), nu, residual));
  petsc::check(VecAYPX(residual, -1, g));
}

}  // namespace stickslip::operators
