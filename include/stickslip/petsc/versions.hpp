#pragma once
/// What differs between the versions of PETSc from 3.18 on, and nothing else.

#include <petscsys.h>

namespace stickslip::petsc {

/// What a function that reads the options of an object is given.
#if PETSC_VERSION_LT(3, 23, 0)
using OptionItems = PetscOptionItems*;
#else
using OptionItems = PetscOptionItems;
#endif

/// Makes a container the owner of the T, made by new, that it points to. Returns PETSc's error
/// code.
template <class T>
[[nodiscard]] PetscErrorCode own_contents(PetscContainer container) {
#if PETSC_VERSION_LT(3, 23, 0)
  return PetscContainerSetUserDestroy(container, [](void* contents) -> PetscErrorCode {
    delete static_cast<T*>(contents);
    return 0;
  });
#else
  // The address of the pointer: a void** in 3.23, a void* later.
  return PetscContainerSetCtxDestroy(container, [](auto address) -> PetscErrorCode {
    delete *static_cast<T**>(static_cast<void*>(address));
    return 0;
  });
#endif
}

}  // namespace stickslip::petsc
