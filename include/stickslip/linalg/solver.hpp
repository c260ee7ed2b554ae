#pragma once
/// A matrix factored once, solved with as often as wanted.

#include <petscksp.h>
#include <petscmat.h>

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stickslip/linalg/solver_options.hpp"
#include "stickslip/linalg/solver_statistics.hpp"
#include "stickslip/linalg/vectors.hpp"

namespace stickslip::linalg {

// How far a solution is from being exact for entries slightly off.

/// Backward errors of solutions with one matrix.
///
/// Its rows differ by many orders of magnitude, so that norms of the whole matrix would hide a bad
/// row; |A| |x| does not. A forward solution is of one size: the largest component counts (Oettli
/// and Prager). A transposed one is an occupation, time spent in each state: |A|^T |x| counts
/// visits, falls off by tens of orders of magnitude, and its sum is what functionals see.
class BackwardError {
 public:
  /// The matrix must outlive this object, and keep its values.
  explicit BackwardError(Mat matrix) : matrix_(matrix) {}

  /// max_i |r|_i / (|A| |x| + |b|)_i with r = b - A x, which is overwritten; to |x| is added 1e-13
  /// of its largest component. Collective.
  [[nodiscard]] double forward(Vec residual, Vec b, Vec x);
  /// sum_i |r|_i / sum_i (|A|^T |x| + |b|)_i with r = b - A^T x. Collective.
  [[nodiscard]] double transposed(Vec residual, Vec b, Vec x);

 private:
  Mat matrix_;
  // |a_ij| and the sums of its rows, when first needed.
  MatHandle magnitude_;
  VecHandle magnitude_sums_;
};

// KSPs with the defaults of this program, and what they report about themselves.

/// Functions composed on a PC of this program: it predicts its cost for the matrix that it has, and
/// is applied to several vectors at once.
using Analyse = PetscErrorCode(PC, Analysis*);
using ApplyToColumns = PetscErrorCode(PC, std::span<const Vec> b, std::span<const Vec> x,
                                      bool transposed);
inline constexpr const char* kAnalyse = "PCAnalyse_C";
inline constexpr const char* kApplyToColumns = "PCApplyToColumns_C";

/// Makes a KSP a direct solver, preonly around an LU factorisation by MUMPS; to be called before
/// its options are read. Not collective.
void set_direct_solver(KSP ksp);

/// The ordering AMF in analyses by MUMPS with this prefix during the life of what it returns,
/// unless -<prefix>mat_mumps_icntl_7 says otherwise: MUMPS would choose PORD, as METIS is not in
/// Debian's build, which costs 10 to 30 times more on these matrices. PETSc takes it from its
/// options alone.
[[nodiscard]] std::unique_ptr<OptionFor> default_ordering(const std::string& prefix);

/// KSP of type preonly around a PC of type `pc_type`; with PCLU around MUMPS. Every choice is a
/// PETSc option under the prefix, e.g. -slide_pc_type lu or -slide_pc_factor_mat_solver_type klu;
/// with any option of the PC or its matrices LU is the default. Collective.
[[nodiscard]] KspHandle linear_solver(Mat matrix, const std::string& prefix, PCType pc_type);

/// Throws NoMemory or NotReached when the factorisation of a KSP has failed.
void require_factored(KSP ksp, const std::string& prefix);

/// Adds memory and entries of the factors of a KSP, as MUMPS or kAnalyse count them; nothing for
/// other solvers.
void record_factors(KSP ksp, SolverStatistics& statistics);

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
  /// Where MUMPS runs out of the workspace that it set aside (INFOG(1) = -8, -9), as pivots against
  /// the order that the analysis foresaw can need more, it is given more once. Throws NoMemory when
  /// the factors do not fit, NotReached when the factorisation fails. `pc_type`: default of
  /// -<prefix>pc_type.
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
  void solve_once(Vec b, Vec x, bool transposed = false);

  /// Orders and analyses `matrix` as the constructor would, and stops there; zeros for solvers that
  /// report nothing. Collective.
  [[nodiscard]] static Analysis analyse(Mat matrix, const std::string& prefix,
                                        SolverStatistics& statistics, PCType pc_type = PCLU);

 private:
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

}  // namespace stickslip::linalg
