#include "stickslip/quantities/uncertain.hpp"

#include "stickslip/petsc/vectors.hpp"

namespace stickslip::quantities {

Uncertain value_of(Vec functional, const petsc::Solution& solution) {
  return {petsc::dot(functional, solution.x),
          std::abs(petsc::dot(functional, solution.correction))};
}

}  // namespace stickslip::quantities
