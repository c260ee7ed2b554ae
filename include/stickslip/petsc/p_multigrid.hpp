#pragma once
/// Two-level p-multigrid for discontinuous Galerkin transport on a chain of levels.

#include <petscmat.h>

#include <memory>

#include "stickslip/petsc/high_modes.hpp"
#include "stickslip/petsc/level_elimination.hpp"
#include "stickslip/petsc/preconditioner.hpp"

namespace stickslip::petsc {

/// Preconditioner that solves the coarse problem exactly and then the high modes of each element,
/// in a cycle of HighModes. In GMRES an iteration leaves a fifth to a tenth of the error.
class PMultigrid final : public Preconditioner {
 public:
  /// `coarse` is for the matrix of the coarse discretisation, which other preconditioners may use
  /// as well; `matrix` is kept by reference count. Collective.
  PMultigrid(Mat matrix, std::shared_ptr<LevelElimination> coarse, Hierarchy hierarchy);

  /// Factors the coarse matrix too unless that is done.
  void factor() override;
  void apply(Vec b, Vec x, bool transposed) const override;

 private:
  std::shared_ptr<LevelElimination> coarse_;
  HighModes high_;
};

}  // namespace stickslip::petsc
