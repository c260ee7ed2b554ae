#pragma once
/// The operators of one discretisation, assembled and factored when first asked for.

#include <petscvec.h>

#include <complex>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "stickslip/generator/discretisation.hpp"
#include "stickslip/generator/generator.hpp"
#include "stickslip/linalg/solver.hpp"
#include "stickslip/linalg/solver_statistics.hpp"
#include "stickslip/linalg/vectors.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::generator {

/// Prefix of the PETSc options of the solver for these operators.
inline const std::string kSlidePrefix = "slide_";

/// Assembles an operator, or its derivative, and enters it in the statistics. Collective.
[[nodiscard]] KolmogorovOperator assemble(MPI_Comm comm, const Discretisation& discretisation,
                                          Shift<PetscScalar> shift, Symmetry symmetry,
                                          StaticPhase static_phase,
                                          linalg::SolverStatistics& statistics,
                                          const std::optional<model::Derivative>& derivative = {});

/// lambda - L with its solver, by default of the type default_pc_type().
class System {
 public:
  /// Collective. Throws NoMemory or NotReached.
  System(KolmogorovOperator a, linalg::SolverStatistics& statistics);

  [[nodiscard]] const KolmogorovOperator& a() const { return a_; }
  [[nodiscard]] linalg::Factorization& factors() { return factors_; }

 private:
  KolmogorovOperator a_;
  linalg::Factorization factors_;
};

/// One system for each key that is asked for, and none else; each is assembled
/// and factored once and serves every solve, forward, transposed or with several right-hand sides.
class Systems {
 public:
  /// `statistics` must outlive this object.
  Systems(MPI_Comm comm, Discretisation discretisation, linalg::SolverStatistics& statistics)
      : comm_(comm), discretisation_(std::move(discretisation)), statistics_(statistics) {}

  /// Collective at first use of a key.
  [[nodiscard]] System& at(const SystemKey& key);
  [[nodiscard]] System& at(double lambda, Symmetry symmetry,
                           StaticPhase static_phase = StaticPhase::killing) {
    return at({lambda, symmetry, static_phase});
  }
  /// Assembles and analyses as that would, and keeps nothing. Collective.
  [[nodiscard]] linalg::Analysis analyse(const SystemKey& key);
  /// Frees a system that is not needed any more. Collective.
  void release(const SystemKey& key) { systems_.erase(key); }
  /// Frees all others. Collective.
  void keep(const std::set<SystemKey>& used) {
    std::erase_if(systems_, [&used](const auto& entry) { return !used.contains(entry.first); });
  }

  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] const Discretisation& discretisation() const { return discretisation_; }
  [[nodiscard]] const model::Process& process() const { return discretisation_.process; }
  [[nodiscard]] linalg::SolverStatistics& statistics() { return statistics_; }

 private:
  [[nodiscard]] KolmogorovOperator assembled(const SystemKey& key);

  MPI_Comm comm_;
  Discretisation discretisation_;
  linalg::SolverStatistics& statistics_;
  std::map<SystemKey, std::unique_ptr<System>> systems_;
};

// Solutions of (z - L) x = b for complex z, whatever the scalar type of PETSc is.

/// Real and imaginary part, each a vector of real numbers.
struct ComplexVector {
  linalg::VecHandle real, imaginary;
};
/// sum_n c_n x_n for a real c. Collective.
[[nodiscard]] std::complex<double> dot(Vec c, const ComplexVector& x);

/// Factors of A + d, A = -L an operator without shift and d a complex one, by state. On hp
/// elements that the PC `elements` serves, in complex arithmetic by ElementElimination, at three to
/// four times the cost of real factors; else as the real system
///
///   ( A + Re d     -Im d  ) (Re x)   (Re b)
///   (  Im d       A + Re d) (Im x) = (Im b)
///
/// by the solver of -slide_, LU unless the options say otherwise.
class ComplexSolver {
 public:
  /// `a` must live as long. Collective. Throws NoMemory or NotReached.
  ComplexSolver(const KolmogorovOperator& a, Shift<std::complex<double>> shift,
                linalg::SolverStatistics& statistics);

  struct Solution {
    ComplexVector x;
    ComplexVector correction;  ///< of iterative refinement: a measure of rounding
    double change = 0;         ///< the norm of the correction relative to that of x
  };
  /// (A + d) x = b, or with the transpose (no conjugation), with a step of iterative refinement.
  /// Collective. Throws NotReached if it does not converge.
  [[nodiscard]] Solution solve(const ComplexVector& b, bool transposed);
  /// The same without refinement, at half the cost. Collective.
  [[nodiscard]] ComplexVector solve_once(const ComplexVector& b, bool transposed);

 private:
  // r = b - (A + d) x.
  [[nodiscard]] ComplexVector residual(const ComplexVector& b, const ComplexVector& x,
                                       bool transposed) const;

  const KolmogorovOperator& a_;
  ComplexVector diagonal_;  // d
  linalg::SolverStatistics& statistics_;
  std::function<void(const ComplexVector& b, const ComplexVector& x, bool transposed)> factors_;
};

}  // namespace stickslip::generator
