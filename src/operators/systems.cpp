#include "stickslip/operators/systems.hpp"

namespace stickslip::operators {

namespace {

template <class Make>
KolmogorovOperator entered(petsc::Ledger& ledger, Make make) {
  const petsc::PhaseTimer timer("assembly", ledger.assembly_seconds);
  KolmogorovOperator a = make();
  petsc::Ledger made;
  made.assemblies = 1;
  made.unknowns = a.states().global_size();
  made.nonzeros = a.nonzeros();
  ledger += made;
  return a;
}

}  // namespace

KolmogorovOperator assemble(MPI_Comm comm, const model::Process& process,
                            const velocity::Axis& axis, PetscScalar lambda, Symmetry symmetry,
                            Rest rest, petsc::Ledger& ledger) {
  return entered(ledger,
                 [&] { return KolmogorovOperator(comm, process, axis, lambda, symmetry, rest); });
}

KolmogorovOperator assemble_derivative(MPI_Comm comm, const model::Process& process,
                                       const velocity::Axis& axis, Symmetry symmetry,
                                       Parameter theta, petsc::Ledger& ledger) {
  return entered(
      ledger, [&] { return KolmogorovOperator::derivative(comm, process, axis, symmetry, theta); });
}

System& Systems::at(double lambda, Symmetry symmetry, Rest rest) {
  auto& system = systems_[{lambda, symmetry, rest}];
  if (!system) {
    system = std::make_unique<System>(
        assemble(comm_, process_, *axis_, lambda, symmetry, rest, ledger_), ledger_);
  }
  return *system;
}

}  // namespace stickslip::operators
