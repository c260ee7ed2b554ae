#pragma once
/// A matrix factored once, solved with as often as wanted.

#include <petscmat.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/petsc/backward_error.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/petsc/linear_solver.hpp"
#include "stickslip/petsc/solver_statistics.hpp"

namespace stickslip::petsc {

/// A solution after iterative refinement. `correction` is the sum of the steps of refinement: x -
/// correction is the solution of one solve alone, and the effect of the correction on a functional
/// estimates the rounding error in the functional.
struct Solution {
  VecHandle x;
  VecHandle correction;
  double backward_error = 0;  ///< of the refined x; see BackwardError
};

/// A direct solver reports success on a singular matrix too, so each solve computes its residual
/// and makes one step of iterative refinement, a second one where the backward error is above
/// 1e-12 still. All members are collective.
class Factorization {
 public:
  /// Analyses and factors `matrix` (kept by reference count). `prefix` without the dash, with the
  /// trailing underscore. Times and counts go to `statistics`, which must outlive this object.
  /// Where MUMPS runs out of the workspace that it set aside (INFOG(1) = -8, -9), it is given more
  /// once. Throws NoMemory when the factors do not fit, NotReached when the factorisation fails.
  /// `pc_type`: default of -<prefix>pc_type.
  Factorization(Mat matrix, const std::string& prefix, SolverStatistics& statistics,
                PCType pc_type = PCLU);

  /// A x = b. Throws NotReached when the backward error stays above 1e-12.
  [[nodiscard]] Solution solve(Vec b) { return std::move(solve({&b, 1}, false)[0]); }
  /// A^T x = b (no conjugation).
  [[nodiscard]] Solution solve_transposed(Vec b) { return std::move(solve({&b, 1}, true)[0]); }
  /// The same for several right-hand sides, each refined and measured by itself; PCs of this
  /// program read their factors once for many.
  [[nodiscard]] std::vector<Solution> solve_transposed(const std::vector<VecHandle>& b) {
    return solve(std::vector<Vec>(b.begin(), b.end()), true);
  }

  /// A x = b and A^T x = b without residual and iterative refinement, for directions that need not
  /// be exact.
  void solve_once(Vec b, Vec x);
  void solve_transposed_once(Vec b, Vec x);

  /// Orders and analyses `matrix` as the constructor would, and stops there. Collective.
  [[nodiscard]] static Analysis analyse(Mat matrix, const std::string& prefix,
                                        SolverStatistics& statistics, PCType pc_type = PCLU);

 private:
  void factor();
  [[nodiscard]] std::vector<Solution> solve(std::span<const Vec> b, bool transposed);
  void solve_some(std::span<const Vec> b, std::span<Solution> solutions, bool transposed);
  [[nodiscard]] std::string advice() const;
  void apply(Vec b, Vec x, bool transposed);
  void apply(std::span<const Vec> b, std::span<const Vec> x, bool transposed);

  MatHandle matrix_;
  BackwardError measure_;
  KspHandle ksp_;
  std::string prefix_;
  SolverStatistics& statistics_;
};

}  // namespace stickslip::petsc
