#include "stickslip/quantities/uncertain.hpp"

#include "stickslip/petsc/check.hpp"

namespace stickslip::quantities {

Uncertain value_of(Vec functional, const petsc::Solution& solution) {
  PetscScalar value = 0, change = 0;
  petsc::check(VecTDot(functional, solution.x, &value));
  petsc::check(VecTDot(functional, solution.correction, &change));
  return {PetscRealPart(value), std::abs(PetscRealPart(change))};
}

}  // namespace stickslip::quantities
