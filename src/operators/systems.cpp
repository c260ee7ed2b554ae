#include "stickslip/operators/systems.hpp"

#include <utility>

#include "stickslip/operators/solver_policy.hpp"

namespace stickslip::operators {

namespace {

template <class Make>
KolmogorovOperator entered(petsc::SolverStatistics& statistics, Make make) {
  const petsc::PhaseTimer timer("assembly", statistics.assembly_seconds);
  KolmogorovOperator a = make();
  petsc::SolverStatistics made;
  made.assemblies = 1;
  made.unknowns = a.states().global_size();
  made.nonzeros = a.nonzeros();
  statistics += made;
  return a;
}

}  // namespace

KolmogorovOperator assemble(MPI_Comm comm, const Discretisation& discretisation, PetscScalar lambda,
                            Symmetry symmetry, StaticPhase rest,
                            petsc::SolverStatistics& statistics) {
  return entered(statistics,
                 [&] { return KolmogorovOperator(comm, discretisation, lambda, symmetry, rest); });
}

KolmogorovOperator assemble_derivative(MPI_Comm comm, const Discretisation& discretisation,
                                       Symmetry symmetry, Parameter theta,
                                       petsc::SolverStatistics& statistics) {
  return entered(statistics, [&] {
    return KolmogorovOperator::derivative(comm, discretisation, symmetry, theta);
  });
}

std::unique_ptr<petsc::Factorization> factorization(const KolmogorovOperator& a,
                                                    petsc::SolverStatistics& statistics) {
  return std::make_unique<petsc::Factorization>(a.matrix(), kSlidePrefix, statistics,
                                                default_pc_type(a.discretisation()));
}

System& Systems::at(double lambda, Symmetry symmetry, StaticPhase rest) {
  auto& system = systems_[{lambda, symmetry, rest}];
  if (!system) {
    auto a = assemble(comm_, discretisation_, lambda, symmetry, rest, statistics_);
    system = std::make_unique<System>(std::move(a), statistics_);
  }
  return *system;
}

petsc::Analysis Systems::analyse(const SystemKey& key) {
  const auto a = assemble(comm_, discretisation_, key.lambda, key.symmetry, key.rest, statistics_);
  return petsc::Factorization::analyse(a.matrix(), kSlidePrefix, statistics_,
                                       default_pc_type(a.discretisation()));
}

}  // namespace stickslip::operators
