#include "stickslip/operators/systems.hpp"

#include <utility>

#include "stickslip/operators/element_elimination.hpp"
#include "stickslip/petsc/session.hpp"

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

petsc::Structure structure_of(const KolmogorovOperator& a, PetscScalar lambda) {
  const Discretisation& d = a.discretisation();
  const bool has_elements = dynamic_cast<const velocity::HpAxis*>(d.axis.get()) != nullptr;
  if (!has_elements || petsc::ranks(a.states().comm()) > 1) return {};
  const auto make = [&a, lambda] {
    return std::make_unique<ElementElimination>(a.discretisation(), a.states(), a.matrix(), lambda);
  };
  return {make, suits_elements(d.noise->count(), d.noise->all_levels())};
}

System& Systems::at(double lambda, Symmetry symmetry, Rest rest) {
  auto& system = systems_[{lambda, symmetry, rest}];
  if (!system) {
    auto a = assemble(comm_, discretisation_, lambda, symmetry, rest, ledger_);
    system = std::make_unique<System>(std::move(a), lambda, ledger_);
  }
  return *system;
}

petsc::Analysis Systems::analyse(const SystemKey& key) {
  const auto a = assemble(comm_, discretisation_, key.lambda, key.symmetry, key.rest, ledger_);
  return petsc::Factorization::analyse(a.matrix(), kSlidePrefix, ledger_,
                                       structure_of(a, key.lambda));
}

}  // namespace stickslip::operators
