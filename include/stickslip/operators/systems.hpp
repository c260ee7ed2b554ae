#pragma once
/// The operators of one discretisation, assembled and factored when first asked for.

#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>

#include "stickslip/model/process.hpp"
#include "stickslip/operators/kolmogorov_operator.hpp"
#include "stickslip/petsc/factorization.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/velocity/axis.hpp"

namespace stickslip::operators {

/// Prefix of the PETSc options of the solver for these operators.
inline const std::string kSlidePrefix = "slide_";

/// Assembles an operator and enters it in the ledger. Collective.
[[nodiscard]] KolmogorovOperator assemble(MPI_Comm comm, const model::Process& process,
                                          const velocity::Axis& axis, PetscScalar lambda,
                                          Symmetry symmetry, Rest rest, petsc::Ledger& ledger);

/// The same for its derivative. Collective.
[[nodiscard]] KolmogorovOperator assemble_derivative(MPI_Comm comm, const model::Process& process,
                                                     const velocity::Axis& axis, Symmetry symmetry,
                                                     Parameter theta, petsc::Ledger& ledger);

/// lambda - L with its factors.
class System {
 public:
  /// Collective. Throws NoMemory or NotReached.
  System(KolmogorovOperator a, petsc::Ledger& ledger)
      : a_(std::move(a)), factors_(a_.matrix(), kSlidePrefix, ledger, a_.states().chain()) {}

  [[nodiscard]] const KolmogorovOperator& a() const { return a_; }
  [[nodiscard]] petsc::Factorization& factors() { return factors_; }

 private:
  KolmogorovOperator a_;
  petsc::Factorization factors_;
};

/// lambda - L on functions of one symmetry.
struct SystemKey {
  double lambda = 0;
  Symmetry symmetry = Symmetry::even;
  Rest rest = Rest::killing;
  friend bool operator<(const SystemKey& a, const SystemKey& b) {
    return std::tie(a.lambda, a.symmetry, a.rest) < std::tie(b.lambda, b.symmetry, b.rest);
  }
};

/// One system for each (lambda, symmetry, rest) that is asked for, and none else; each is assembled
/// and factored once and serves every solve, plain, transposed or with several right-hand sides.
class Systems {
 public:
  /// `ledger` must outlive this object.
  Systems(MPI_Comm comm, const model::Process& process, std::shared_ptr<const velocity::Axis> axis,
          petsc::Ledger& ledger)
      : comm_(comm), process_(process), axis_(std::move(axis)), ledger_(ledger) {}

  /// Collective at first use of a key.
  [[nodiscard]] System& at(double lambda, Symmetry symmetry, Rest rest = Rest::killing);
  /// Frees a system that is not needed any more. Collective.
  void release(double lambda, Symmetry symmetry, Rest rest = Rest::killing) {
    systems_.erase({lambda, symmetry, rest});
  }
  /// Frees all others. Collective.
  void keep(const std::set<SystemKey>& used) {
    std::erase_if(systems_, [&used](const auto& entry) { return !used.contains(entry.first); });
  }

  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] const model::Process& process() const { return process_; }
  [[nodiscard]] const velocity::Axis& axis() const { return *axis_; }
  [[nodiscard]] const std::shared_ptr<const velocity::Axis>& shared_axis() const { return axis_; }
  [[nodiscard]] petsc::Ledger& ledger() { return ledger_; }

 private:
  MPI_Comm comm_;
  model::Process process_;
  std::shared_ptr<const velocity::Axis> axis_;
  petsc::Ledger& ledger_;
  std::map<SystemKey, std::unique_ptr<System>> systems_;
};

}  // namespace stickslip::operators
