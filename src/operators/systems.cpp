#include "stickslip/operators/systems.hpp"

#include <algorithm>
#include <utility>

#include "stickslip/operators/hierarchy.hpp"

namespace stickslip::operators {

namespace {

// Degrees 0, 1, 2 take 23, 17, 14 iterations and about the same time; factors grow like the square
// of one more than the degree. With 0, noise of tau = 2^-12 took more than 60.
constexpr int kCoarseDegree = 1;

template <class Make>
auto timed(const char* phase, double& seconds, Make make) {
  const petsc::PhaseTimer timer(phase, seconds);
  return make();
}

bool same_nodes(const velocity::Axis& a, const velocity::Axis& b) {
  return std::ranges::equal(a.nodes(), b.nodes()) && std::ranges::equal(a.cells(), b.cells());
}

template <class Make>
KolmogorovOperator entered(petsc::Ledger& ledger, Make make) {
  KolmogorovOperator a = timed("assembly", ledger.assembly_seconds, make);
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
                            Rest rest, petsc::Ledger& ledger, Form form) {
  return entered(ledger, [&] {
    return KolmogorovOperator(comm, process, axis, lambda, symmetry, rest, form);
  });
}

KolmogorovOperator assemble_derivative(MPI_Comm comm, const model::Process& process,
                                       const velocity::Axis& axis, Symmetry symmetry,
                                       Parameter theta, petsc::Ledger& ledger) {
  return entered(
      ledger, [&] { return KolmogorovOperator::derivative(comm, process, axis, symmetry, theta); });
}

CoarseSystem::CoarseSystem(MPI_Comm comm, const model::Process& process,
                           std::shared_ptr<const velocity::HpAxis> coarse_axis,
                           const SystemKey& which, petsc::Ledger& ledger)
    : key(which),
      axis(std::move(coarse_axis)),
      a(timed("assembly", ledger.assembly_seconds,
              [&] {
                return KolmogorovOperator(comm, process, *axis, key.lambda, key.symmetry, key.rest);
              })),
      elimination(timed("analysis", ledger.analysis_seconds,
                        [&] { return petsc::LevelElimination(a.matrix(), a.states().chain()); })) {}

petsc::Structure Operators::structure(petsc::Ledger& ledger) {
  const petsc::PhaseTimer timer("analysis", ledger.analysis_seconds);
  petsc::Structure structure = a.states().structure();
  if (!coarse) return structure;
  auto levels = hierarchy(a.states(), *axis, coarse->a.states(), *coarse->axis);
  auto* elimination = &coarse->elimination;
  structure.multigrid = std::make_unique<petsc::PMultigrid>(
      a.matrix(), std::shared_ptr<petsc::LevelElimination>(std::move(coarse), elimination),
      std::move(levels));
  structure.assembled = [this] { return assembled.emplace(assemble()).matrix(); };
  return structure;
}

Operators Systems::operators(const SystemKey& key) {
  const auto made = [this, key](Form form) {
    return assemble(comm_, process_, *axis_, key.lambda, key.symmetry, key.rest, ledger_, form);
  };
  const bool iterates =
      petsc::chosen_solver(kSlidePrefix, preferred_) == petsc::Solver::p_multigrid;
  const auto axis = std::dynamic_pointer_cast<const velocity::HpAxis>(axis_);
  if (!iterates || !axis) return {made(Form::assembled)};
  Operators result{made(Form::by_elements)};
  result.axis = axis;
  result.assemble = [made] { return made(Form::assembled); };
  result.coarse = coarse_for(key, *axis);
  return result;
}

std::shared_ptr<CoarseSystem> Systems::coarse_for(const SystemKey& key,
                                                  const velocity::HpAxis& axis) {
  auto coarse_axis = axis.coarsened(kCoarseDegree);
  if (offered_ && offered_->key == key && same_nodes(*offered_->axis, *coarse_axis)) {
    return std::move(offered_);
  }
  return std::make_shared<CoarseSystem>(comm_, process_, std::move(coarse_axis), key, ledger_);
}

System& Systems::at(double lambda, Symmetry symmetry, Rest rest) {
  const SystemKey key{lambda, symmetry, rest};
  auto& system = systems_[key];
  if (!system) system = std::make_unique<System>(operators(key), ledger_);
  return *system;
}

petsc::Analysis Systems::analyse(const SystemKey& key) {
  Operators made = operators(key);
  return petsc::Factorization::analyse(made.a.matrix(), kSlidePrefix, ledger_,
                                       made.structure(ledger_));
}

}  // namespace stickslip::operators
