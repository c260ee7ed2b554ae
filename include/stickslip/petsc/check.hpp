#pragma once
/// One way to call PETSc: check(PetscSomething(...)) throws what PETSc reports.

#include <petscsys.h>

#include <new>
#include <stdexcept>
#include <string>

namespace stickslip::petsc {

/// PETSc or one of its packages reported an error; the text holds its message and call chain.
class PetscFailure : public std::runtime_error {
 public:
  PetscFailure(PetscErrorCode code, const std::string& text)
      : std::runtime_error(text), code_(code) {}
  [[nodiscard]] PetscErrorCode code() const noexcept { return code_; }

 private:
  PetscErrorCode code_;
};

/// Throws PetscFailure unless `code` is 0. PetscErrorCode is a plain int in this build of PETSc, so
/// that a call without check(...) would compile and lose its error; the lint looks for those.
void check(PetscErrorCode code);

/// Runs f, which PETSc called: exceptions may not pass through PETSc, errors go back as codes.
template <class F>
[[nodiscard]] PetscErrorCode guarded(F f) {
  try {
    f();
  } catch (const PetscFailure& failure) {
    return failure.code();
  } catch (const std::bad_alloc&) {
    return PETSC_ERR_MEM;
  }
  return 0;
}

/// Routes PETSc's error reports into the text of the next PetscFailure. Called once by Session.
void collect_error_messages();

}  // namespace stickslip::petsc
