#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "../common/catch.hpp"
#include "../common/temporary.hpp"
#include "stickslip/base/files.hpp"

using namespace stickslip;
using stickslip::test::content;
using stickslip::test::TemporaryFolder;

TEST_CASE("atomic file: the target changes at commit and not before") {
  const TemporaryFolder folder;
  const auto target = folder / "result";
  write_text(target, "old");
  {
    AtomicFile file(target, 1);
    std::ofstream(file.part()) << "new";
    CHECK(content(target) == "old");
    file.commit();
    CHECK(content(target) == "new");
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("atomic file: without commit nothing changes and nothing is left") {
  const TemporaryFolder folder;
  const auto target = folder / "result";
  write_text(target, "old");
  {
    const AtomicFile file(target, 2);
    std::ofstream(file.part()) << "half";
  }
  CHECK(content(target) == "old");
  CHECK(folder.entries() == 1);
}

TEST_CASE("atomic file: a link stays, and the file behind it changes") {
  const TemporaryFolder folder;
  const auto target = folder / "result", link = folder / "link";
  std::filesystem::create_symlink("result", link);
  for (const std::string text : {"first", "second"}) {
    write_text(link, text);
    CHECK(content(target) == text);
  }
  CHECK(std::filesystem::is_symlink(link));
  CHECK(folder.entries() == 2);
}

TEST_CASE("atomic file: no file takes the place of a pipe") {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_THROWS_WITH(write_text(pipe, "text"), Catch::Contains("cannot replace " + pipe));
  CHECK(std::filesystem::is_fifo(pipe));
  CHECK(folder.entries() == 1);
}

TEST_CASE("atomic file: a place that cannot be written is reported") {
  CHECK_THROWS_WITH(write_text("/no/such/folder/file", "text"),
                    Catch::Contains("/no/such/folder/file"));
}

TEST_CASE("atomic file: what stands beside the part goes with it, and nothing else") {
  const test::TemporaryFolder folder;
  const std::string target = folder / "out.h5";
  std::ofstream(folder / "out.h5.part8") << "of another run";
  {
    const AtomicFile file(target, 7);
    std::ofstream(file.part()) << "half";
    std::ofstream(file.part() + "-1.lock") << "lock";
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("atomic file: parts of a run whose number begins alike stay") {
  const TemporaryFolder folder;
  const auto target = folder / "result";
  const AtomicFile other(target, 123);
  std::ofstream(other.part()) << "at work";
  { const AtomicFile file(target, 12); }
  CHECK(content(other.part()) == "at work");
}
