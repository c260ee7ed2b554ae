#pragma once
/// Solutions of (z - L) x = b for complex z, whatever the scalar type of PETSc is.

#include <petscvec.h>

#include <complex>
#include <memory>

#include "stickslip/operators/kolmogorov_operator.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/solver_statistics.hpp"

namespace stickslip::operators {

/// Real and imaginary part, each a vector of real numbers.
struct ComplexVector {
  petsc::VecHandle real, imaginary;
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
                petsc::SolverStatistics& statistics);
  ~ComplexSolver();
  ComplexSolver(const ComplexSolver&) = delete;
  ComplexSolver& operator=(const ComplexSolver&) = delete;

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
  class Factors;
  class ByElements;
  class InRealForm;

  // r = b - (A + d) x.
  [[nodiscard]] ComplexVector residual(const ComplexVector& b, const ComplexVector& x,
                                       bool transposed) const;

  const KolmogorovOperator& a_;
  ComplexVector diagonal_;  // d
  petsc::SolverStatistics& statistics_;
  std::unique_ptr<Factors> factors_;
};

}  // namespace stickslip::operators
