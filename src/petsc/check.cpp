#include "stickslip/petsc/check.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <utility>

namespace stickslip::petsc {
namespace {

std::string& pending_text() {
  static std::string text;
  return text;
}

std::exception_ptr& kept_exception() {
  static std::exception_ptr exception;
  return exception;
}

// Of errors by exceptions; PETSc itself has none of that number.
constexpr PetscErrorCode kException = PETSC_ERR_MAX_VALUE + 1;

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
  const auto exception = std::exchange(kept_exception(), nullptr);
  if (code == kException && exception) std::rethrow_exception(exception);
  if (text.empty()) text = fmt::format("PETSc error {}", code);
  throw PetscFailure(code, text);
}

PetscErrorCode keep_exception() noexcept {
  kept_exception() = std::current_exception();
  return kException;
}

namespace {

constexpr const char* kOutOfMemory =
    "memory ran out; take a larger -delta, a looser -accuracy or more ranks, or raise the limit "
    "(ulimit -v)";

constexpr const char* kPleaseReport =
    "this should not happen, please report it with the command line: ";

Failure failure_of(const PetscFailure& failure) {
  const std::string text = failure.what(), message = text.substr(0, text.find('\n'));
  switch (failure.code()) {
  case PETSC_ERR_MEM: return {ExitStatus::no_memory, kOutOfMemory};
  case PETSC_ERR_NOT_CONVERGED: return {ExitStatus::not_reached, message};
  case PETSC_ERR_USER_INPUT: return {ExitStatus::bad_input, message};
  default: return {ExitStatus::other, text};
  }
}

}  // namespace

Failure failure_in_flight() {
  try {
    throw;
  } catch (const Failure& failure) {
    return failure;
  } catch (const std::bad_alloc&) {
    return {ExitStatus::no_memory, kOutOfMemory};
  } catch (const PetscFailure& failure) {
    return failure_of(failure);
  } catch (const std::exception& unforeseen) {
    return {ExitStatus::other, kPleaseReport + std::string(unforeseen.what())};
  } catch (...) {  // muParser's are none of these
    return {ExitStatus::other, kPleaseReport + std::string("an error without words")};
  }
}

void collect_error_messages() { check(PetscPushErrorHandler(append_message, nullptr)); }

}  // namespace stickslip::petsc
