#include "../common/catch.hpp"
#include "stickslip/linalg/petsc.hpp"
#include "stickslip/linalg/vectors.hpp"

using namespace stickslip::linalg;

namespace {

int references(Vec vec) {
  PetscInt count = 0;
  check(PetscObjectGetReference(reinterpret_cast<PetscObject>(vec), &count));
  return static_cast<int>(count);
}

VecHandle make_vector() {
  VecHandle x;
  check(VecCreateSeq(PETSC_COMM_SELF, 3, x.out()));
  return x;
}

// A second reference, so that the count shows whether a handle has let go.
Vec shared(const VecHandle& handle) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(static_cast<Vec>(handle))));
  return handle;
}

}  // namespace

TEST_CASE("handle: owns exactly one reference through moves") {
  VecHandle first = make_vector();
  Vec observer = shared(first);
  REQUIRE(references(observer) == 2);
  VecHandle second = std::move(first);
  CHECK(static_cast<Vec>(first) == nullptr);  // NOLINT(bugprone-use-after-move): what is tested
  CHECK(references(observer) == 2);
  {
    const VecHandle third = std::move(second);
    CHECK(references(observer) == 2);
  }
  CHECK(references(observer) == 1);
  check(VecDestroy(&observer));
}

TEST_CASE("handle: assignment and out() release what was held") {
  VecHandle handle = make_vector();
  Vec observer = shared(handle);
  handle = make_vector();
  CHECK(references(observer) == 1);
  check(VecDestroy(&observer));
  observer = shared(handle);
  check(VecCreateSeq(PETSC_COMM_SELF, 2, handle.out()));
  CHECK(references(observer) == 1);
  check(VecDestroy(&observer));
}

TEST_CASE("check: an error of PETSc becomes an exception with its message") {
  const VecHandle x = make_vector();
  const PetscInt beyond = 3;
  PetscScalar value = 0;
  try {
    check(VecGetValues(x, 1, &beyond, &value));
    check(VecSetType(x, "no such type"));
    FAIL("no error reported");
  } catch (const PetscFailure& failure) {
    CHECK(failure.code() != 0);
    CHECK_THAT(failure.what(), Catch::Contains("no such type"));
  }
  CHECK_NOTHROW(check(VecSet(x, 1)));  // and leaves nothing behind
}
