#include "stickslip/quantities/pencil.hpp"

#include <cmath>
#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {

using operators::Clock;
using petsc::check;

ProcessPencil::ProcessPencil(operators::Systems& systems, operators::Symmetry symmetry,
                             operators::StaticPhase static_phase, Clock clock)
    : systems_(systems),
      key_{0, symmetry, static_phase, clock},
      a_(operators::assemble(systems.comm(), systems.discretisation(), 0, symmetry, static_phase,
                             systems.statistics())) {
  if (clock == Clock::time) return;
  root_ = a_.zeros();
  inverse_root_ = a_.zeros();
  petsc::WriteView root(root_), inverse(inverse_root_);
  PetscInt at = 0;
  a_.states().for_each_local([&](const operators::State& state) {
    const double rate = rate_of(clock, state, *systems.discretisation().velocities);
    root[at] = std::sqrt(rate);
    inverse[at++] = 1 / std::sqrt(rate);
  });
}

ProcessPencil::~ProcessPencil() {
  for (const auto& key : used_) systems_.release(key);
}

void ProcessPencil::by_clock(int power, Vec x) const {
  if (root_ != nullptr) check(VecPointwiseMult(x, x, power > 0 ? root_ : inverse_root_));
}

void ProcessPencil::multiply(Vec x, Vec y, bool transposed) const {
  const petsc::VecHandle scaled = petsc::copy_of(x);
  by_clock(-1, scaled);
  check(transposed ? MatMultTranspose(a_.matrix(), scaled, y) : MatMult(a_.matrix(), scaled, y));
  by_clock(-1, y);
}

void ProcessPencil::solve(double z, Vec b, Vec x, bool transposed, bool refined) {
  auto key = key_;
  key.lambda = z;
  used_.insert(key);
  auto& factors = systems_.at(key).factors();
  const petsc::VecHandle scaled = petsc::copy_of(b);
  by_clock(1, scaled);
  if (refined) {
    check(VecCopy(transposed ? factors.solve_transposed(scaled).x : factors.solve(scaled).x, x));
  } else {
    transposed ? factors.solve_transposed_once(scaled, x) : factors.solve_once(scaled, x);
  }
  by_clock(1, x);
}

class ProcessPencil::Shifted final : public ShiftedPencil {
 public:
  Shifted(const ProcessPencil& pencil, std::complex<double> z)
      : pencil_(pencil), solver_(pencil.a_, {z, pencil.key_.clock}, pencil.systems_.statistics()) {}

  [[nodiscard]] operators::ComplexVector solve(const operators::ComplexVector& b,
                                               bool transposed) override {
    operators::ComplexVector scaled{petsc::copy_of(b.real), petsc::copy_of(b.imaginary)};
    const auto by_clock = [this](const operators::ComplexVector& x) {
      for (Vec part : {Vec(x.real), Vec(x.imaginary)}) pencil_.by_clock(1, part);
    };
    by_clock(scaled);
    auto solution = solver_.solve(scaled, transposed);
    by_clock(solution.x);
    return std::move(solution.x);
  }

 private:
  const ProcessPencil& pencil_;
  operators::ComplexSolver solver_;
};

std::unique_ptr<ShiftedPencil> ProcessPencil::shifted(std::complex<double> z) {
  return std::make_unique<Shifted>(*this, z);
}

}  // namespace stickslip::quantities
