#pragma once
/// The operators of one discretisation, assembled and factored when first asked for.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "stickslip/model/process.hpp"
#include "stickslip/operators/kolmogorov_operator.hpp"
#include "stickslip/petsc/factorization.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/velocity/axis.hpp"
#include "stickslip/velocity/hp_axis.hpp"

namespace stickslip::operators {

/// Prefix of the PETSc options of the solver for these operators.
inline const std::string kSlidePrefix = "slide_";

/// Assembles an operator and enters it in the ledger. Collective.
[[nodiscard]] KolmogorovOperator assemble(MPI_Comm comm, const model::Process& process,
                                          const velocity::Axis& axis, PetscScalar lambda,
                                          Symmetry symmetry, Rest rest, petsc::Ledger& ledger,
                                          Form form = Form::assembled);

/// The same for its derivative. Collective.
[[nodiscard]] KolmogorovOperator assemble_derivative(MPI_Comm comm, const model::Process& process,
                                                     const velocity::Axis& axis, Symmetry symmetry,
                                                     Parameter theta, petsc::Ledger& ledger);

/// A system on the lowest degrees, for p-multigrid on any higher ones of the same elements.
struct CoarseSystem {
  /// Assembles and analyses; what first uses it factors it. Collective.
  CoarseSystem(MPI_Comm comm, const model::Process& process,
               std::shared_ptr<const velocity::HpAxis> axis, const SystemKey& key,
               petsc::Ledger& ledger);

  SystemKey key;
  std::shared_ptr<const velocity::HpAxis> axis;
  KolmogorovOperator a;
  petsc::LevelElimination elimination;
};

/// What a system is made of.
struct Operators {
  KolmogorovOperator a;
  std::shared_ptr<CoarseSystem> coarse = {};          ///< for p-multigrid
  std::shared_ptr<const velocity::HpAxis> axis = {};  ///< of A, if so
  /// A with all entries, for p-multigrid, which has it by elements; made when it comes to that.
  std::function<KolmogorovOperator()> assemble = {};
  std::optional<KolmogorovOperator> assembled = {};

  /// Refers to this object, and takes the coarse system from it. Collective.
  [[nodiscard]] petsc::Structure structure(petsc::Ledger& ledger);
};

/// lambda - L with its solver.
class System {
 public:
  /// Collective. Throws NoMemory or NotReached.
  System(Operators operators, petsc::Ledger& ledger)
      : operators_(std::move(operators)),
        coarse_(operators_.coarse),
        factors_(a().matrix(), kSlidePrefix, ledger, operators_.structure(ledger)) {}

  [[nodiscard]] const KolmogorovOperator& a() const { return operators_.a; }
  [[nodiscard]] petsc::Factorization& factors() { return factors_; }
  /// Of one that iterates, as long as it does; null for others.
  [[nodiscard]] std::shared_ptr<CoarseSystem> coarse() const { return coarse_.lock(); }

 private:
  Operators operators_;
  std::weak_ptr<CoarseSystem> coarse_;  // which the solver owns
  petsc::Factorization factors_;
};

/// One system for each (lambda, symmetry, rest) that is asked for, and none else; each is assembled
/// and factored once and serves every solve, plain, transposed or with several right-hand sides.
class Systems {
 public:
  /// `ledger` must outlive this object.
  Systems(MPI_Comm comm, const model::Process& process, std::shared_ptr<const velocity::Axis> axis,
          petsc::Ledger& ledger)
      : comm_(comm), process_(process), axis_(std::move(axis)), ledger_(ledger) {}

  /// Prefers p-multigrid where the axis has a degree to lower: for few solves with large systems.
  void prefer_iteration() { preferred_ = petsc::Solver::p_multigrid; }

  /// Offers a coarse system of the same process to the first one of its key that iterates, which
  /// takes it if it has the same elements. Local.
  void offer(std::shared_ptr<CoarseSystem> coarse) { offered_ = std::move(coarse); }

  /// Collective at first use of a key.
  [[nodiscard]] System& at(double lambda, Symmetry symmetry, Rest rest = Rest::killing);
  /// Assembles and analyses as that would, and keeps nothing. Collective.
  [[nodiscard]] petsc::Analysis analyse(const SystemKey& key);
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
  [[nodiscard]] Operators operators(const SystemKey& key);
  [[nodiscard]] std::shared_ptr<CoarseSystem> coarse_for(const SystemKey& key,
                                                         const velocity::HpAxis& axis);

  MPI_Comm comm_;
  model::Process process_;
  std::shared_ptr<const velocity::Axis> axis_;
  petsc::Ledger& ledger_;
  petsc::Solver preferred_ = petsc::Solver::levels;
  std::map<SystemKey, std::unique_ptr<System>> systems_;
  std::shared_ptr<CoarseSystem> offered_;
};

}  // namespace stickslip::operators
