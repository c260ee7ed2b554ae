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

}  // namespace stickslip::petsc
