#include "stickslip/petsc/p_multigrid.hpp"

#include <array>
#include <utility>

#include "stickslip/petsc/check.hpp"

namespace stickslip::petsc {

PMultigrid::PMultigrid(Mat matrix, Mat coarse, Chain chain, Hierarchy hierarchy)
    : coarse_(coarse, std::move(chain)), high_(matrix, std::move(hierarchy)) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(matrix)));
  matrix_ = MatHandle(matrix);
  check(MatCreateVecs(coarse, coarse_x_.out(), coarse_b_.out()));
  check(MatCreateVecs(matrix_, nullptr, residual_.out()));
  std::array<double, 2> sums{high_.entries(), high_.operations()};
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_DOUBLE, MPI_SUM,
                PetscObjectComm(reinterpret_cast<PetscObject>(matrix)));
  set_cost(sums[0] + coarse_.entries(), sizeof(PetscScalar) * sums[0] + coarse_.bytes(),
           sums[1] + coarse_.operations());
}

void PMultigrid::factor() {
  coarse_.factor();
  high_.factor();
}

void PMultigrid::apply(Vec b, Vec x, bool transposed) const {
  restrict_to_coarse(high_.hierarchy(), b, coarse_b_, transposed);
  coarse_.apply(coarse_b_, coarse_x_, transposed);
  prolong(high_.hierarchy(), coarse_x_, x, transposed);
  check(transposed ? MatMultTranspose(matrix_, x, residual_) : MatMult(matrix_, x, residual_));
  check(VecAYPX(residual_, -1, b));
  high_.add(residual_, x, transposed);
}

}  // namespace stickslip::petsc
