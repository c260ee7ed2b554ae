#include "stickslip/support/isolated.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "stickslip/support/errors.hpp"

namespace stickslip {
namespace {

[[noreturn]] void fail(const char* what) {
  throw SystemFailure(fmt::format("{}: {}", what, std::strerror(errno)));
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

}  // namespace

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

}  // namespace stickslip
