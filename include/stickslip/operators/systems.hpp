#pragma once
/// The operators of one discretisation, assembled and factored when first asked for.

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "stickslip/model/derivative.hpp"
#include "stickslip/operators/discretisation.hpp"
#include "stickslip/operators/kolmogorov_operator.hpp"
#include "stickslip/petsc/factorization.hpp"
#include "stickslip/petsc/solver_statistics.hpp"

namespace stickslip::operators {

/// Prefix of the PETSc options of the solver for these operators.
inline const std::string kSlidePrefix = "slide_";

/// Assembles an operator and enters it in the statistics. Collective.
[[nodiscard]] KolmogorovOperator assemble(MPI_Comm comm, const Discretisation& discretisation,
                                          Shift<PetscScalar> shift, Symmetry symmetry,
                                          StaticPhase static_phase,
                                          petsc::SolverStatistics& statistics);

/// The same for its derivative. Collective.
[[nodiscard]] KolmogorovOperator
assemble_derivative(MPI_Comm comm, const Discretisation& discretisation, Symmetry symmetry,
                    const model::Derivative& theta, petsc::SolverStatistics& statistics);

/// The solver of an operator, which must live as long: by default of the type default_pc_type().
/// Collective. Throws NoMemory or NotReached.
[[nodiscard]] std::unique_ptr<petsc::Factorization>
factorization(const KolmogorovOperator& a, petsc::SolverStatistics& statistics);

/// lambda - L with its solver.
class System {
 public:
  /// Collective. Throws NoMemory or NotReached.
  System(KolmogorovOperator a, petsc::SolverStatistics& statistics)
      : a_(std::move(a)), factors_(factorization(a_, statistics)) {}

  [[nodiscard]] const KolmogorovOperator& a() const { return a_; }
  [[nodiscard]] petsc::Factorization& factors() { return *factors_; }

 private:
  KolmogorovOperator a_;
  std::unique_ptr<petsc::Factorization> factors_;
};

/// One system for each key that is asked for, and none else; each is assembled
/// and factored once and serves every solve, forward, transposed or with several right-hand sides.
class Systems {
 public:
  /// `statistics` must outlive this object.
  Systems(MPI_Comm comm, Discretisation discretisation, petsc::SolverStatistics& statistics)
      : comm_(comm), discretisation_(std::move(discretisation)), statistics_(statistics) {}

  /// Collective at first use of a key.
  [[nodiscard]] System& at(const SystemKey& key);
  [[nodiscard]] System& at(double lambda, Symmetry symmetry,
                           StaticPhase static_phase = StaticPhase::killing) {
    return at({lambda, symmetry, static_phase});
  }
  /// Assembles and analyses as that would, and keeps nothing. Collective.
  [[nodiscard]] petsc::Analysis analyse(const SystemKey& key);
  /// Frees a system that is not needed any more. Collective.
  void release(const SystemKey& key) { systems_.erase(key); }
  /// Frees all others. Collective.
  void keep(const std::set<SystemKey>& used) {
    std::erase_if(systems_, [&used](const auto& entry) { return !used.contains(entry.first); });
  }

  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] const Discretisation& discretisation() const { return discretisation_; }
  [[nodiscard]] const model::Process& process() const { return discretisation_.process; }
  [[nodiscard]] petsc::SolverStatistics& statistics() { return statistics_; }

 private:
  [[nodiscard]] KolmogorovOperator assembled(const SystemKey& key);

  MPI_Comm comm_;
  Discretisation discretisation_;
  petsc::SolverStatistics& statistics_;
  std::map<SystemKey, std::unique_ptr<System>> systems_;
};

}  // namespace stickslip::operators
