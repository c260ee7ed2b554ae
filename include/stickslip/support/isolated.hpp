#pragma once
/// Work that may end its process.

#include <functional>
#include <optional>
#include <string>

namespace stickslip {

/// What `work` returns, done in a child process; nothing if a signal ended that process, as a fault
/// of a library does, or if it took longer than `seconds`. Exceptions must not leave `work`.
/// Throws SystemFailure if no process can be started.
[[nodiscard]] std::optional<std::string> isolated(const std::function<std::string()>& work,
                                                  unsigned seconds);

}  // namespace stickslip
