#include "stickslip/base/files.hpp"

#include <boost/crc.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "stickslip/base/errors.hpp"

namespace stickslip {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw SystemFailure(fmt::format("{}: {}", what, std::strerror(errno)));
}

void flush_to_disk(const std::string& file) {
  const int descriptor = open(file.c_str(), O_RDONLY);
  if (descriptor < 0) fail("cannot open " + file);
  const int status = fsync(descriptor);
  close(descriptor);
  if (status != 0) fail("cannot flush " + file);
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

// How the child ends shows a fault: no handler and no core file is wanted.
void let_faults_end_this_process(unsigned seconds) {
  for (int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGALRM, SIGPIPE}) {
    std::signal(signal, SIG_DFL);
  }
  const rlimit none{0, 0};
  (void)setrlimit(RLIMIT_CORE, &none);
  (void)std::freopen("/dev/null", "w", stderr);
  alarm(seconds);
}

[[noreturn]] void work_as_child(int out, const std::function<std::string()>& work,
                                unsigned seconds) {
  let_faults_end_this_process(seconds);
  const std::string text = work();
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t part = write(out, text.data() + sent, text.size() - sent);
    if (part <= 0) _exit(1);
    sent += static_cast<std::size_t>(part);
  }
  _exit(0);  // the parent's files and MPI are not this process's to close
}

std::string read_all(int in) {
  std::string text;
  std::array<char, 65536> part{};
  for (ssize_t size = 0; (size = read(in, part.data(), part.size())) != 0;) {
    if (size > 0) text.append(part.data(), static_cast<std::size_t>(size));
    if (size < 0 && errno != EINTR) break;
  }
  return text;
}

constexpr std::string_view kMember = R"(,"check":")";
constexpr std::size_t kDigits = 16, kTail = kMember.size() + kDigits + 2;  // and the closing "}

// CRC-64/XZ: against accidents, not against forgery.
std::string checksum(const std::string& text) {
  boost::crc_optimal<64, 0x42f0e1eba9ea3693, ~0ull, ~0ull, true, true> crc;
  crc.process_bytes(text.data(), text.size());
  return fmt::format("{:016x}", crc.checksum());
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
    fail("cannot replace " + target_);
  }
  if (std::rename(part_.c_str(), target_.c_str()) != 0) fail("cannot write " + target_);
  committed_ = true;
}

void write_text(const std::string& target, const std::string& text) {
  AtomicFile file(target, getpid());
  std::FILE* stream = std::fopen(file.part().c_str(), "wb");
  if (stream == nullptr) fail("cannot write " + target);
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  const bool closed = std::fclose(stream) == 0;
  if (!written || !closed) fail("cannot write " + target);
  file.commit();
}

std::optional<std::string> isolated(const std::function<std::string()>& work, unsigned seconds) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) fail("no pipe");
  const pid_t child = fork();
  if (child < 0) fail("no process");
  if (child == 0) work_as_child(ends[1], work, seconds);
  close(ends[1]);
  std::string text = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool done = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return done ? std::optional(std::move(text)) : std::nullopt;
}

std::string sealed(const std::string& object) {
  if (!object.ends_with('}')) throw std::invalid_argument("only an object can be sealed");
  std::string text = object.substr(0, object.size() - 1);
  text += fmt::format("{}{}\"}}", kMember, checksum(object));
  return text;
}

std::optional<std::string> unsealed(const std::string& text) {
  if (text.size() < kTail) return std::nullopt;
  std::string object = text.substr(0, text.size() - kTail) + "}";
  if (sealed(object) != text) return std::nullopt;
  return object;
}

}  // namespace stickslip
