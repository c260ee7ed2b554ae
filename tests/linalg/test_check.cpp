#include <new>
#include <petscmat.h>
#include <stdexcept>

#include "../common/catch.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip;
using linalg::check;

namespace {

template <class Thrown>
PetscErrorCode throwing(Mat, Vec, Vec) {
  return linalg::guarded([] { throw Thrown("from within"); });
}

template <>
PetscErrorCode throwing<std::bad_alloc>(Mat, Vec, Vec) {
  return linalg::guarded([] { throw std::bad_alloc(); });
}

template <>
PetscErrorCode throwing<int>(Mat, Vec, Vec) {
  return linalg::guarded([] { throw 3; });
}

template <>
PetscErrorCode throwing<linalg::PetscFailure>(Mat, Vec, Vec) {
  return linalg::guarded([] { throw linalg::PetscFailure(PETSC_ERR_FP, "a first error"); });
}

// A product by a matrix whose own function throws, with frames of PETSc in between.
template <class Thrown>
void multiply() {
  linalg::MatHandle matrix;
  check(MatCreateShell(PETSC_COMM_SELF, 2, 2, 2, 2, nullptr, matrix.out()));
  check(MatShellSetOperation(matrix, MATOP_MULT, reinterpret_cast<void (*)()>(&throwing<Thrown>)));
  linalg::VecHandle x, y;
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
  CHECK_THROWS_WITH(multiply<linalg::PetscFailure>(), "a first error");
}

TEST_CASE("check: an exception that PETSc swallowed does not come out later") {
  (void)linalg::guarded([] { throw NotReached("swallowed"); });
  CHECK_NOTHROW(check(0));
  linalg::VecHandle x;
  check(VecCreateSeq(PETSC_COMM_SELF, 1, x.out()));
  CHECK_THROWS_AS(check(VecSetSizes(x, 5, 5)), linalg::PetscFailure);
}

TEST_CASE("check: without an exception an error of PETSc has the text of PETSc") {
  linalg::VecHandle x;
  check(VecCreate(PETSC_COMM_SELF, x.out()));
  CHECK_THROWS_WITH(check(VecSetType(x, "nonsense")), Catch::Contains("nonsense"));
}
