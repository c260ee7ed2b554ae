#include "stickslip/support/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "stickslip/support/errors.hpp"

namespace stickslip {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& file) {
  throw SystemFailure(fmt::format("{} {}: {}", what, file, std::strerror(errno)));
}

void flush_to_disk(const std::string& file) {
  const int descriptor = open(file.c_str(), O_RDONLY);
  if (descriptor < 0) fail("cannot open", file);
  const int status = fsync(descriptor);
  close(descriptor);
  if (status != 0) fail("cannot flush", file);
}

// The part, and what writers put beside it: "name.part12" and "name.part12.lock", but no
// "name.part123", which belongs to another run.
void remove_with_companions(const std::filesystem::path& start) {
  std::error_code error;
  const auto folder = start.has_parent_path() ? start.parent_path() : ".";
  const std::string name = start.filename();
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;) {
    const std::filesystem::path file = at->path();
    at.increment(error);
    std::error_code kept;
    const std::string found = file.filename().string();
    const bool ours = found.starts_with(name) &&
                      (found.size() == name.size() || std::isdigit(found[name.size()]) == 0);
    if (ours) std::filesystem::remove(file, kept);
  }
}

// What a symbolic link stands for, lest a file takes the place of the link.
std::string followed(const std::string& target) {
  constexpr int most = 40;  // links from one to the next, as for the system
  std::filesystem::path file = target;
  std::error_code error;
  for (int n = 0; n < most && std::filesystem::is_symlink(file, error); ++n) {
    file = file.parent_path() / std::filesystem::read_symlink(file, error);
  }
  return file.string();
}

}  // namespace

AtomicFile::AtomicFile(const std::string& target, long tag)
    : target_(followed(target)), part_(fmt::format("{}.part{}", target_, tag)) {}

// MPI leaves a lock beside the part where a disk was full.
AtomicFile::~AtomicFile() {
  if (!committed_) remove_with_companions(part_);
}

void AtomicFile::commit() {
  flush_to_disk(part_);
  std::error_code error;
  if (std::filesystem::exists(target_, error) &&
      !std::filesystem::is_regular_file(target_, error)) {
    errno = EINVAL;  // a device or a pipe would be gone
    fail("cannot replace", target_);
  }
  if (std::rename(part_.c_str(), target_.c_str()) != 0) fail("cannot write", target_);
  committed_ = true;
}

void write_text(const std::string& target, const std::string& text) {
  AtomicFile file(target, getpid());
  std::FILE* stream = std::fopen(file.part().c_str(), "wb");
  if (stream == nullptr) fail("cannot write", target);
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  const bool closed = std::fclose(stream) == 0;
  if (!written || !closed) fail("cannot write", target);
  file.commit();
}

}  // namespace stickslip
