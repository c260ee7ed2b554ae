#include "stickslip/petsc/check.hpp"

#include <fmt/format.h>

#include <utility>

namespace stickslip::petsc {
namespace {

std::string& pending_text() {
  static std::string text;
  return text;
}

PetscErrorCode append_message(MPI_Comm, int line, const char* function, const char* file,
                              PetscErrorCode code, PetscErrorType type, const char* message,
                              void*) {
  std::string& text = pending_text();
  if (type == PETSC_ERROR_INITIAL) {
    text = fmt::format("PETSc error {}: {}", code, message != nullptr ? message : "");
  }
  text += fmt::format("\n  in {}() at {}:{}", function, file, line);
  return code;
}

}  // namespace

void check(PetscErrorCode code) {
  if (code == 0) return;
  std::string text = std::exchange(pending_text(), {});
  if (text.empty()) text = fmt::format("PETSc error {}", code);
  throw PetscFailure(code, text);
}

void collect_error_messages() { check(PetscPushErrorHandler(append_message, nullptr)); }

}  // namespace stickslip::petsc
