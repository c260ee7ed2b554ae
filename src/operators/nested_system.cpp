#include "stickslip/operators/nested_system.hpp"

#include <algorithm>
#include <utility>

#include "stickslip/operators/hierarchy.hpp"
#include "stickslip/petsc/check.hpp"

namespace stickslip::operators {
namespace {

constexpr int kCycles = 2;

}  // namespace

NestedSystem::NestedSystem(Systems& coarse, std::shared_ptr<const velocity::Axis> axis,
                           petsc::Ledger& ledger)
    : process_(coarse.process()),
      axis_(std::move(axis)),
      coarse_(coarse.at(0, symmetry_of(process_))),
      ledger_(ledger),
      a_(assemble(coarse.comm(), process_, *axis_, 0, symmetry_of(process_), Rest::killing, ledger,
                  Form::by_elements)),
      high_(a_.matrix(), coarse_.a().matrix(),
            hierarchy(a_.states(), *axis_, coarse_.a().states(), coarse.axis())),
      measure_(a_.matrix()) {
  const petsc::PhaseTimer timer("factorisation", ledger.factorization_seconds);
  high_.factor();
}

petsc::Solution NestedSystem::solve_transposed(Vec g, Vec guess) {
  const petsc::PhaseTimer timer("solve", ledger_.solve_seconds);
  petsc::Solution s{a_.zeros(), a_.zeros()};
  const petsc::VecHandle residual = a_.zeros();
  const auto solve_coarse = [this](Vec b, Vec x, bool transposed) {
    coarse_.factors().precondition(b, x, transposed);
  };
  petsc::check(VecCopy(guess, s.x));
  compute_residual(g, s.x, residual);
  high_.add(residual, s.x, true);
  for (int n = 0; n < kCycles; ++n) {
    compute_residual(g, s.x, residual);
    high_.cycle(solve_coarse, residual, s.correction, true);
    petsc::check(VecAXPY(s.x, 1, s.correction));
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
