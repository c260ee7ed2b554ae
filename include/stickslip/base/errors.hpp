#pragma once
/// The ways in which a run can end early, each with its exit status.

#include <stdexcept>
#include <string>
#include <utility>

namespace stickslip {

/// Exit statuses of the command line; scripts rely on them.
enum class ExitStatus { done = 0, other = 1, bad_input = 2, not_reached = 3, no_memory = 4 };

/// What each status says, for the manual.
inline constexpr std::pair<int, const char*> kExitMeanings[] = {
    {0, "done"},
    {1, "other error"},
    {2, "bad input"},
    {3, "accuracy not reached or a solver failed (what was reached is still written)"},
    {4, "would not fit in memory"}};

/// Base of every error that carries an exit status of its own.
class Failure : public std::runtime_error {
 public:
  Failure(ExitStatus status, const std::string& message)
      : std::runtime_error(message), status_(status) {}
  [[nodiscard]] ExitStatus status() const noexcept { return status_; }

 private:
  ExitStatus status_;
};

/// The input is wrong; the message names option, value, range and fix. Thrown before any solve.
class BadInput : public Failure {
 public:
  explicit BadInput(const std::string& message) : Failure(ExitStatus::bad_input, message) {}
};

/// A solver failed, or no discretisation reaches what was asked for.
class NotReached : public Failure {
 public:
  explicit NotReached(const std::string& message) : Failure(ExitStatus::not_reached, message) {}
};

/// The problem does not fit in memory; thrown before the memory is taken.
class NoMemory : public Failure {
 public:
  explicit NoMemory(const std::string& message) : Failure(ExitStatus::no_memory, message) {}
};

/// The machine refused: a file cannot be written, a process not be started.
class SystemFailure : public Failure {
 public:
  explicit SystemFailure(const std::string& message) : Failure(ExitStatus::other, message) {}
};

}  // namespace stickslip
