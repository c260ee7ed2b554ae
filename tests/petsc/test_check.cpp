#include <new>
#include <petscmat.h>
#include <stdexcept>

#include "../common/catch.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/handle.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using petsc::check;

namespace {

template <class Thrown>
PetscErrorCode throwing(Mat, Vec, Vec) {
  return petsc::guarded([] { throw Thrown("from within"); });
}

template <>
PetscErrorCode throwing<std::bad_alloc>(Mat, Vec, Vec) {
  return petsc::guarded([] { throw std::bad_alloc(); });
}

template <>
PetscErrorCode throwing<int>(Mat, Vec, Vec) {
  return petsc::guarded([] { throw 3; });
}

template <>
PetscErrorCode throwing<petsc::PetscFailure>(Mat, Vec, Vec) {
  return petsc::guarded([] { throw petsc::PetscFailure(PETSC_ERR_FP, "a first error"); });
}

// A product by a matrix whose own function throws, with frames of PETSc in between.
template <class Thrown>
void multiply() {
  petsc::MatHandle matrix;
  check(MatCreateShell(PETSC_COMM_SELF, 2, 2, 2, 2, nullptr, matrix.out()));
  check(MatShellSetOperation(matrix, MATOP_MULT, reinterpret_cast<void (*)()>(&throwing<Thrown>)));
  petsc::VecHandle x, y;
  check(MatCreateVecs(matrix, x.out(), y.out()));
  check(MatMult(matrix, x, y));
}

}  // namespace

TEST_CASE("check: what a function called by PETSc throws comes out as it was thrown") {
  CHECK_THROWS_AS(multiply<NotReached>(), NotReached);
  CHECK_THROWS_WITH(multiply<NotReached>(), "from within");
  CHECK_THROWS_AS(multiply<NoMemory>(), NoMemory);
  CHECK_THROWS_AS(multiply<std::out_of_range>(), std::out_of_range);
  CHECK_THROWS_AS(multiply<std::bad_alloc>(), std::bad_alloc);
  CHECK_THROWS_AS(multiply<int>(), int);
  CHECK_THROWS_WITH(multiply<petsc::PetscFailure>(), "a first error");
}

TEST_CASE("check: an exception that PETSc swallowed does not come out later") {
  (void)petsc::guarded([] { throw NotReached("swallowed"); });
  CHECK_NOTHROW(check(0));
  petsc::VecHandle x;
  check(VecCreateSeq(PETSC_COMM_SELF, 1, x.out()));
  CHECK_THROWS_AS(check(VecSetSizes(x, 5, 5)), petsc::PetscFailure);
}

TEST_CASE("check: without an exception an error of PETSc has the text of PETSc") {
  petsc::VecHandle x;
  check(VecCreate(PETSC_COMM_SELF, x.out()));
  CHECK_THROWS_WITH(check(VecSetType(x, "nonsense")), Catch::Contains("nonsense"));
}
