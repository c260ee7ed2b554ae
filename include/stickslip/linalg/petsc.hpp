#pragma once
/// One way to call PETSc: check(PetscSomething(...)) throws what PETSc reports.

#include <petscsys.h>

#include <stdexcept>
#include <string>

#include "stickslip/base/errors.hpp"

namespace stickslip::linalg {

/// PETSc or one of its packages reported an error; the text holds its message and call chain.
class PetscFailure : public std::runtime_error {
 public:
  PetscFailure(PetscErrorCode code, const std::string& text)
      : std::runtime_error(text), code_(code) {}
  [[nodiscard]] PetscErrorCode code() const noexcept { return code_; }

 private:
  PetscErrorCode code_;
};

/// Throws PetscFailure unless `code` is 0, or what a guarded function threw. PetscErrorCode is a
/// plain int in this build of PETSc, so that a call without check(...) would compile and lose its
/// error; the lint looks for those.
void check(PetscErrorCode code);

/// Keeps the exception in flight for the check(...) around the call of PETSc that led to it, and
/// returns the code that PETSc is to hand on. Called in a catch block.
[[nodiscard]] PetscErrorCode keep_exception() noexcept;

/// Runs f, which PETSc called: no exception may pass through PETSc's frames. The check(...) around
/// them throws it again.
template <class F>
[[nodiscard]] PetscErrorCode guarded(F f) noexcept {
  try {
    f();
  } catch (...) {
    return keep_exception();
  }
  return 0;
}

/// What the exception in flight says to a user, with the exit status that it means. What no code
/// foresaw, as errors of libraries, asks for a report. Called in a catch block.
[[nodiscard]] Failure failure_in_flight();

}  // namespace stickslip::linalg
