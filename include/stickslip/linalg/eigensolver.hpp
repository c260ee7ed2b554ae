#pragma once
/// Eigenpairs of a matrix nearest to a target.

#include <petscpc.h>

#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "stickslip/linalg/solver_statistics.hpp"
#include "stickslip/linalg/vectors.hpp"

namespace stickslip::linalg {

struct Eigenpair {
  std::complex<double> value;
  /// Parts of the vector. With real scalars `imaginary` is zero for a real pair; with complex ones
  /// `real` holds both parts and `imaginary` is not used.
  VecHandle real, imaginary;
  double residual = 0;  ///< ||A x - value x||_2 / ||x||_2
};

/// How the matrix less a target is solved: by a PC of a type, made from a matrix of the caller's.
struct ShiftedSolver {
  /// A - target; where empty, SLEPc makes it.
  std::function<auto(PetscScalar target)->MatHandle> matrix;
  PCType pc_type = PCLU;  ///< with PCLU by MUMPS
};

/// SLEPc's EPS: Krylov-Schur with shift-and-invert. Every choice is an option under the prefix:
/// -null_eps_tol 1e-10, -relax_st_pc_factor_mat_solver_type klu, ... All members are collective.
class Eigensolver {
 public:
  /// Finds `wanted` eigenpairs nearest to `target` (-..._eps_nev and -..._eps_target override),
  /// which must not be an eigenvalue. `matrix` must outlive this object. Throws NotReached when
  /// fewer converge, NoMemory when the factors do not fit.
  Eigensolver(Mat matrix, const std::string& prefix, double target, int wanted,
              SolverStatistics& statistics, const ShiftedSolver& shifted = {});

  /// As many as wanted, and the conjugate of the last one: which others converge as well is a
  /// matter of rounding. Nearest to the target first.
  [[nodiscard]] const std::vector<Eigenpair>& pairs() const { return pairs_; }

  /// One step of inverse iteration, x <- (A - target)^-1 x: what it changes shows rounding.
  void iterate(Vec x);

 private:
  void collect_pairs();

  Mat matrix_;
  std::string prefix_;
  EpsHandle eps_;
  std::vector<Eigenpair> pairs_;
};

}  // namespace stickslip::linalg
