#pragma once
/// A matrix factored once, solved with as often as wanted.

#include <petscmat.h>

#include <functional>
#include <memory>
#include <string>

#include "stickslip/petsc/backward_error.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/ledger.hpp"
#include "stickslip/petsc/level_elimination.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/p_multigrid.hpp"

namespace stickslip::petsc {

/// A solution with its corrections summed up; solution - correction is what one solve alone gave,
/// and the effect of the correction on a functional estimates the rounding error in it.
struct Solution {
  VecHandle x;
  VecHandle correction;
  double backward_error = 0;  ///< of the corrected x; see BackwardError
};

/// What is known of a matrix besides its entries.
struct Structure {
  std::function<Chain()> chain = {};  ///< for an elimination by levels, asked when it comes to that
  bool narrow = false;  ///< blocks of the chain are so small that dense ones beat sparse ones
  std::unique_ptr<PMultigrid> multigrid = nullptr;  ///< for iteration, preferred where there is one
  /// The matrix with all entries, where one for iteration lacks them; collective.
  std::function<Mat()> assembled = {};

  [[nodiscard]] Solver preferred() const;
};

/// A direct solver reports success on a singular matrix too, so each solve computes its residual
/// and makes one step of iterative refinement, a second one where the backward error is above
/// 1e-12 still; where iteration by p-multigrid, which nobody asked for, does not come to that, an
/// elimination takes its place. All members are collective.
class Factorization {
 public:
  /// Analyses and factors `matrix` (kept by reference count). `prefix` without the dash, with the
  /// trailing underscore. Times and counts go to `ledger`, which must outlive this object.
  /// Where MUMPS runs out of the workspace that it set aside (INFOG(1) = -8, -9), it is given more
  /// once. Throws NoMemory when the factors do not fit, NotReached when the factorisation fails.
  Factorization(Mat matrix, const std::string& prefix, Ledger& ledger, Structure structure = {});

  /// A x = b. Throws NotReached when the backward error stays above 1e-12.
  [[nodiscard]] Solution solve(Vec b) { return solve(b, false, nullptr); }
  /// A^T x = b (no conjugation). A guess saves iterations where there are any.
  [[nodiscard]] Solution solve_transposed(Vec b, Vec guess = nullptr) {
    return solve(b, true, guess);
  }
  /// Whether solutions are found by iteration.
  [[nodiscard]] bool iterates() const;

  /// A x = b and A^T x = b without the residual and its correction, for directions that need not be
  /// exact.
  void solve_once(Vec b, Vec x);
  void solve_transposed_once(Vec b, Vec x);

  /// A x = b or A^T x = b roughly, for errors that are small already: exactly by factors, to about
  /// a digit where they serve an iteration. Collective.
  void precondition(Vec b, Vec x, bool transposed);

  /// Factors again after the values of the matrix, not its pattern, have changed; the analysis is
  /// kept.
  void update();

  /// Orders and analyses `matrix` as the constructor would, and stops there. Collective.
  [[nodiscard]] static Analysis analyse(Mat matrix, const std::string& prefix, Ledger& ledger,
                                        Structure structure = {});

 private:
  void keep(Mat matrix);
  void factor();
  void factor_by_petsc();
  [[nodiscard]] Solution solve(Vec b, bool transposed, Vec guess);
  [[nodiscard]] Solution solve_by_ksp(Vec b, bool transposed, Vec guess);
  void use(Structure structure);
  [[nodiscard]] bool replaceable() const;
  void eliminate_instead();
  [[nodiscard]] std::string advice() const;
  void apply(Vec b, Vec x, bool transposed, bool from_guess = false);

  MatHandle matrix_;
  BackwardError measure_;
  std::unique_ptr<Preconditioner> own_;  // null: PETSc's preconditioner does it all
  KspHandle ksp_;
  std::function<Chain()> chain_;
  std::function<Mat()> assembled_;
  std::string prefix_;
  Ledger& ledger_;
};

}  // namespace stickslip::petsc
