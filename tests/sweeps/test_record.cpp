#include "stickslip/sweeps/record.hpp"

#include <catch2/catch.hpp>
#include <fstream>

#include "../common/temporary.hpp"
#include "stickslip/support/errors.hpp"

using namespace stickslip;
using namespace stickslip::sweeps;
using Lines = std::vector<std::string>;

namespace {

const Identity kRun{{"commit", "abc"}, {"-mu_d", "0.5"}, {"-sweep_tau", "1,2"}};

std::string complaint(const std::string& file, const Identity& run) {
  const std::string before = test::content(file);
  try {
    (void)open_record(file, run);
  } catch (const BadInput& bad) {
    CHECK(test::content(file) == before);
    return bad.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("record: lines come back as they were written") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "record";
  CHECK(open_record(file, kRun).empty());
  CHECK(open_record(file, kRun).empty());
  append_to_record(file, R"({"point":1})");
  append_to_record(file, R"({"point":0})");
  CHECK(open_record(file, kRun) == Lines{R"({"point":1})", R"({"point":0})"});
}

TEST_CASE("record: a line that was cut off goes, wherever it was cut") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "record";
  (void)open_record(file, kRun);
  const std::string header = test::content(file);
  append_to_record(file, "first");
  append_to_record(file, "second");
  const std::string whole = test::content(file);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::ofstream(file) << whole.substr(0, size);
    const auto lines = open_record(file, kRun);
    INFO(size);
    CHECK(lines.size() == (size < header.size() + 6 ? 0 : 1));
    append_to_record(file, "next");
    CHECK(open_record(file, kRun).size() == lines.size() + 1);
    CHECK(open_record(file, kRun).back() == "next");
  }
}

TEST_CASE("record: that of another sweep is refused, and stays as it is") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "record";
  (void)open_record(file, kRun);
  append_to_record(file, "first");
  Identity other = kRun;
  other[1].second = "0.25";
  CHECK_THAT(complaint(file, other), Catch::Contains("-checkpoint = " + file) &&
                                         Catch::Contains("-mu_d \"0.5\", not \"0.25\""));
  other = kRun;
  other.emplace_back("-slide_pc_type", "lu");
  CHECK_THAT(complaint(file, other), Catch::Contains("-slide_pc_type \"none\", not \"lu\""));
  other = kRun;
  other.pop_back();
  CHECK_THAT(complaint(file, other), Catch::Contains("-sweep_tau"));
}

TEST_CASE("record: what is no record is refused, and stays as it is") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "record";
  for (const std::string text : {"precious\n", "{\"format\":\"stickslip checkpoint 1\"}\n", "{}\n",
                                 "[1]\n", "{\"format\":7}", "\n"}) {
    std::ofstream(file) << text;
    INFO(text);
    CHECK_THAT(complaint(file, kRun), Catch::Contains("is no record of a sweep"));
  }
  CHECK_THROWS_AS(open_record("/dev/null", kRun), BadInput);
  CHECK_THROWS_AS(append_to_record(folder / "no/such/record", "line"), std::runtime_error);
}

TEST_CASE("record: lines are inspected before anything is cut off") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "record";
  (void)open_record(file, kRun);
  append_to_record(file, "bad");
  std::ofstream(file, std::ios::app) << "cut off";
  const std::string before = test::content(file);
  const auto refuse = [](const std::string& line) { throw BadInput(line); };
  CHECK_THROWS_AS(open_record(file, kRun, refuse), BadInput);
  CHECK(test::content(file) == before);
  CHECK(open_record(file, kRun) == Lines{"bad"});
}
