#pragma once
/// Files that appear whole or not at all.

#include <functional>
#include <optional>
#include <string>

namespace stickslip {

/// A name beside `target` to write to; commit() moves it over the target in one step. Without
/// commit, the destructor removes what was written, and the target stays as it was. Of a symbolic
/// link the file that it stands for is the target.
class AtomicFile {
 public:
  /// `tag` distinguishes runs that write the same target; ranks of one run share it.
  AtomicFile(const std::string& target, long tag);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write.
  [[nodiscard]] const std::string& part() const { return part_; }
  /// Flushes to disk and renames; to be called by one process. Throws SystemFailure when the
  /// disk refuses, and where the target is no regular file.
  void commit();

 private:
  std::string target_, part_;
  bool committed_ = false;
};

/// Writes `text` to `target` atomically. Throws SystemFailure with the system's reason.
void write_text(const std::string& target, const std::string& text);

// Work that may end its process.

/// What `work` returns, done in a child process; nothing if a signal ended that process, as a fault
/// of a library does, or if it took longer than `seconds`. Exceptions must not leave `work`.
/// Throws SystemFailure if no process can be started.
[[nodiscard]] std::optional<std::string> isolated(const std::function<std::string()>& work,
                                                  unsigned seconds);

// Checksums of what is kept between runs: a digit that a disk has changed still reads as a number.

/// The text of a JSON object with a last member "check", the checksum of what stands before it.
/// Throws std::invalid_argument if `object` does not end with a brace.
[[nodiscard]] std::string sealed(const std::string& object);

/// The object that was sealed; nothing unless the checksum is right.
[[nodiscard]] std::optional<std::string> unsealed(const std::string& text);

}  // namespace stickslip
