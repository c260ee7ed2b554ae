#include "stickslip/petsc/p_multigrid.hpp"

#include <array>
#include <utility>

namespace stickslip::petsc {

PMultigrid::PMultigrid(Mat matrix, std::shared_ptr<LevelElimination> coarse, Hierarchy hierarchy)
    : coarse_(std::move(coarse)), high_(matrix, coarse_->matrix(), std::move(hierarchy)) {
  std::array<double, 2> sums{high_.entries(), high_.operations()};
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_DOUBLE, MPI_SUM,
                PetscObjectComm(reinterpret_cast<PetscObject>(matrix)));
  set_cost(sums[0] + coarse_->entries(), sizeof(PetscScalar) * sums[0] + coarse_->bytes(),
           sums[1] + coarse_->operations());
}

void PMultigrid::factor() {
  if (!coarse_->factored()) coarse_->factor();
  high_.factor();
}

void PMultigrid::apply(Vec b, Vec x, bool transposed) const {
  const auto solve = [this](Vec own_b, Vec own_x, bool t) { coarse_->apply(own_b, own_x, t); };
  high_.cycle(solve, b, x, transposed);
}

}  // namespace stickslip::petsc
