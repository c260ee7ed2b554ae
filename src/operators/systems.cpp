#include "stickslip/operators/systems.hpp"

#include <utility>

#include "stickslip/operators/solver_policy.hpp"

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

KolmogorovOperator assemble(MPI_Comm comm, const Discretisation& discretisation, PetscScalar lambda,
                            Symmetry symmetry, Rest rest, petsc::Ledger& ledger) {
  return entered(ledger,
                 [&] { return KolmogorovOperator(comm, discretisation, lambda, symmetry, rest); });
}

KolmogorovOperator assemble_derivative(MPI_Comm comm, const Discretisation& discretisation,
                                       Symmetry symmetry, Parameter theta, petsc::Ledger& ledger) {
  return entered(ledger, [&] {
    return KolmogorovOperator::derivative(comm, discretisation, symmetry, theta);
  });
}

std::unique_ptr<petsc::Factorization> factorization(const KolmogorovOperator& a,
                                                    petsc::Ledger& ledger) {
  return std::make_unique<petsc::Factorization>(a.matrix(), kSlidePrefix, ledger,
                                                default_pc_type(a.discretisation()));
}

System& Systems::at(double lambda, Symmetry symmetry, Rest rest) {
  auto& system = systems_[{lambda, symmetry, rest}];
  if (!system) {
    auto a = assemble(comm_, discretisation_, lambda, symmetry, rest, ledger_);
    system = std::make_unique<System>(std::move(a), ledger_);
  }
  return *system;
}

petsc::Analysis Systems::analyse(const SystemKey& key) {
  const auto a = assemble(comm_, discretisation_, key.lambda, key.symmetry, key.rest, ledger_);
  return petsc::Factorization::analyse(a.matrix(), kSlidePrefix, ledger_,
                                       default_pc_type(a.discretisation()));
}

}  // namespace stickslip::operators
