#include "../common/catch.hpp"
#include "stickslip/run/campaign.hpp"

#include <fstream>

#include "../common/temporary.hpp"
#include "stickslip/base/errors.hpp"

using namespace stickslip;
using namespace stickslip::run;
using Entries = std::vector<std::string>;

namespace {

const Identity kRun{{"commit", "abc"}, {"-mu_d", "0.5"}, {"-sweep_tau", "1,2"}};

Checkpoint sweep(const std::string& file, const Identity& run = kRun) {
  return {file, CheckpointKind::sweep, run};
}

Entries entries(const Checkpoint& checkpoint) {
  Entries all;
  checkpoint.open(MPI_COMM_SELF, [&](const std::string& entry) { all.push_back(entry); });
  return all;
}

std::string complaint(const std::string& file, const Checkpoint& checkpoint) {
  const std::string before = test::content(file);
  try {
    (void)entries(checkpoint);
  } catch (const BadInput& bad) {
    CHECK(test::content(file) == before);
    return bad.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("checkpoint: entries come back as they were written") {
  const test::TemporaryFolder folder;
  const Checkpoint checkpoint = sweep(folder / "kept");
  CHECK(entries(checkpoint).empty());
  CHECK(entries(checkpoint).empty());
  checkpoint.append(R"({"point":1})");
  checkpoint.append(R"({"point":0})");
  CHECK(entries(checkpoint) == Entries{R"({"point":1})", R"({"point":0})"});
}

TEST_CASE("checkpoint: options in another order are the same run") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "kept";
  const Checkpoint before = sweep(file);
  (void)entries(before);
  before.append(R"({"point":1})");
  CHECK(entries(sweep(file, {kRun.rbegin(), kRun.rend()})) == Entries{R"({"point":1})"});
}

TEST_CASE("checkpoint: a truncated line goes, wherever it ends") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "kept";
  const Checkpoint checkpoint = sweep(file);
  (void)entries(checkpoint);
  const std::string header = test::content(file);
  checkpoint.append(R"({"point":1})");
  const std::size_t two_lines = test::content(file).size();
  checkpoint.append(R"({"point":2})");
  const std::string whole = test::content(file);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::ofstream(file) << whole.substr(0, size);
    const auto found = entries(checkpoint);
    INFO(size);
    CHECK(found.size() == (size < two_lines ? 0 : 1));
    checkpoint.append(R"({"point":3})");
    CHECK(entries(checkpoint).size() == found.size() + 1);
    CHECK(entries(checkpoint).back() == R"({"point":3})");
  }
  CHECK(whole.starts_with(header));
}

TEST_CASE("checkpoint: that of another sweep is refused, and stays as it is") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "kept";
  (void)entries(sweep(file));
  sweep(file).append("{}");
  Identity other = kRun;
  other[1].second = "0.25";
  CHECK_THAT(complaint(file, sweep(file, other)),
             Catch::Contains("-checkpoint = " + file) &&
                 Catch::Contains("belongs to a sweep with -mu_d \"0.5\", not \"0.25\""));
  other = kRun;
  other.emplace_back("-slide_pc_type", "lu");
  CHECK_THAT(complaint(file, sweep(file, other)),
             Catch::Contains("-slide_pc_type \"none\", not \"lu\""));
  other = kRun;
  other.pop_back();
  CHECK_THAT(complaint(file, sweep(file, other)), Catch::Contains("-sweep_tau"));
  CHECK_THAT(complaint(file, {file, CheckpointKind::simulation, kRun}),
             Catch::Contains("is no checkpoint of a simulation"));
}

TEST_CASE("checkpoint: what is none is refused, and stays as it is") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "kept";
  for (const std::string text :
       {"precious\n", "{\"format\":\"stickslip checkpoint 1\"}\n", "{}\n", "[1]\n",
        "{\"format\":\"stickslip sweep 1\",\"run\":{\"commit\":\"abc\"}}\n", "{\"format\":7}",
        "\n"}) {
    std::ofstream(file) << text;
    INFO(text);
    CHECK_THAT(complaint(file, sweep(file)), Catch::Contains("is no checkpoint of a sweep"));
  }
  CHECK_THROWS_AS(entries(sweep("/dev/null")), BadInput);
  CHECK_THROWS_AS(sweep(folder / "no/such/folder").append("{}"), std::runtime_error);
}

TEST_CASE("checkpoint: entries are inspected before anything is truncated") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "kept";
  const Checkpoint checkpoint = sweep(file);
  (void)entries(checkpoint);
  checkpoint.append(R"({"bad":1})");
  std::ofstream(file, std::ios::app) << "cut off";
  const std::string before = test::content(file);
  const auto refuse = [](const std::string& entry) { throw std::out_of_range(entry); };
  CHECK_THROWS_AS(checkpoint.open(MPI_COMM_SELF, refuse), BadInput);
  CHECK(test::content(file) == before);
  CHECK(entries(checkpoint) == Entries{R"({"bad":1})"});
}

TEST_CASE("checkpoint: the state of a simulation replaces the one before, and is never truncated") {
  const test::TemporaryFolder folder;
  const std::string file = folder / "kept";
  const Checkpoint checkpoint(file, CheckpointKind::simulation, kRun);
  CHECK(entries(checkpoint).empty());
  checkpoint.replace(R"({"rounds":1})");
  const std::string first = test::content(file);
  checkpoint.replace(R"({"rounds":2})");
  CHECK(entries(checkpoint) == Entries{R"({"rounds":2})"});
  const std::string whole = test::content(file), second = whole.substr(whole.find('\n') + 1);
  for (const auto& text : {whole.substr(0, whole.size() - 1), first + second}) {
    std::ofstream(file) << text;
    CHECK_THAT(complaint(file, checkpoint), Catch::Contains("is damaged"));
  }
}
