#include "stickslip/operators/matrix_data.hpp"

#include <utility>

#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/versions.hpp"

namespace stickslip::operators {
namespace {

using petsc::check;
using Shared = std::shared_ptr<const MatrixData>;

constexpr const char* kName = "stickslip_data";

}  // namespace

void attach(Mat matrix, Shared data) {
  const auto object = reinterpret_cast<PetscObject>(matrix);
  PetscContainer container = nullptr;
  check(PetscContainerCreate(PetscObjectComm(object), &container));
  check(PetscContainerSetPointer(container, new Shared(std::move(data))));
  check(petsc::own_contents<Shared>(container));
  check(PetscObjectCompose(object, kName, reinterpret_cast<PetscObject>(container)));
  check(PetscContainerDestroy(&container));
}

Shared data_of(Mat matrix) {
  PetscObject found = nullptr;
  check(PetscObjectQuery(reinterpret_cast<PetscObject>(matrix), kName, &found));
  if (found == nullptr) return nullptr;
  void* data = nullptr;
  check(PetscContainerGetPointer(reinterpret_cast<PetscContainer>(found), &data));
  return *static_cast<Shared*>(data);
}

}  // namespace stickslip::operators
