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

/// One that always ends in the same status.
template <ExitStatus ends_in>
class FailureOf : public Failure {
 public:
  explicit FailureOf(const std::string& message) : Failure(ends_in, message) {}
};

/// The input is wrong; the message names option, value, range and fix. Thrown before any solve.
using BadInput = FailureOf<ExitStatus::bad_input>;
/// A solver failed, or no discretisation reaches what was asked for.
using NotReached = FailureOf<ExitStatus::not_reached>;
/// The problem does not fit in memory; thrown before the memory is taken.
using NoMemory = FailureOf<ExitStatus::no_memory>;
/// The machine refused: a file cannot be written, a process not be started.
using SystemFailure = FailureOf<ExitStatus::other>;

}  // namespace stickslip
