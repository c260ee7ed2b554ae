#include <unistd.h>

#include <csignal>

#include "../common/catch.hpp"
#include "stickslip/base/files.hpp"

using stickslip::isolated;

TEST_CASE("isolated: what the work returns, of any length") {
  const std::string large(1 << 20, 'x');
  CHECK(isolated([] { return std::string("done"); }, 10) == "done");
  CHECK(isolated([&] { return large; }, 10) == large);
}

TEST_CASE("isolated: a signal or an end of its own is no result") {
  const auto ended_by = [](int signal) {
    return isolated(
        [signal] {
          (void)std::raise(signal);
          return std::string("not reached");
        },
        10);
  };
  CHECK_FALSE(ended_by(SIGSEGV));
  CHECK_FALSE(ended_by(SIGKILL));
  CHECK_FALSE(isolated([]() -> std::string { _exit(3); }, 10));
}

TEST_CASE("isolated: work without end is stopped") {
  CHECK_FALSE(isolated(
      []() -> std::string {
        for (;;) pause();
      },
      1));
}
