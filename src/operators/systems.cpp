#include "stickslip/operators/systems.hpp"

#include <cmath>
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

KolmogorovOperator assemble(MPI_Comm comm, const Discretisation& discretisation,
                            Shift<PetscScalar> shift, Symmetry symmetry, StaticPhase static_phase,
                            petsc::SolverStatistics& statistics) {
  return entered(statistics, [&] {
    return KolmogorovOperator(comm, discretisation, shift, symmetry, static_phase);
  });
}

KolmogorovOperator assemble_derivative(MPI_Comm comm, const Discretisation& discretisation,
                                       Symmetry symmetry, const model::Derivative& theta,
                                       petsc::SolverStatistics& statistics) {
  return entered(statistics, [&] {
    return KolmogorovOperator::derivative(comm, discretisation, symmetry, theta);
  });
}

namespace {

// Elements know of no killing in one state.
const char* pc_type_of(const KolmogorovOperator& a) {
  return a.kills_in_one_state() ? "lu" : default_pc_type(a.discretisation());
}

}  // namespace

std::unique_ptr<petsc::Factorization> factorization(const KolmogorovOperator& a,
                                                    petsc::SolverStatistics& statistics) {
  return std::make_unique<petsc::Factorization>(a.matrix(), kSlidePrefix, statistics,
                                                pc_type_of(a));
}

KolmogorovOperator Systems::assembled(const SystemKey& key) {
  const auto of = [&](const Discretisation& discretisation) {
    return assemble(comm_, discretisation, key.shift(), key.symmetry, key.static_phase,
                    statistics_);
  };
  if (key.passage) return of(discretisation_.passing(key.speed_limit, key.passage));
  if (!std::isinf(key.speed_limit)) return of(discretisation_.killing_at(key.speed_limit));
  KolmogorovOperator a = of(discretisation_);
  const bool singular = key.lambda == 0 && key.static_phase == StaticPhase::killing;
  if (singular && !process().sticks()) a.kill_in_one_state();
  return a;
}

System& Systems::at(const SystemKey& key) {
  auto& system = systems_[key];
  if (!system) system = std::make_unique<System>(assembled(key), statistics_);
  return *system;
}

petsc::Analysis Systems::analyse(const SystemKey& key) {
  const auto a = assembled(key);
  return petsc::Factorization::analyse(a.matrix(), kSlidePrefix, statistics_, pc_type_of(a));
}

}  // namespace stickslip::operators
