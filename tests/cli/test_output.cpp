#include "stickslip/cli/output.hpp"

#include <petscsys.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "../common/catch.hpp"
#include "../common/temporary.hpp"
#include "../common/written.hpp"
#include "stickslip/linalg/session.hpp"

using namespace stickslip;
using namespace stickslip::cli;

namespace {

Report report(Subject subject, MPI_Comm comm) {
  Report made;
  made.subject = subject;
  made.comm = comm;
  made.provenance = {{"program", "by hand"}};
  made.options = {{"mu_d", "0.5"}};
  made.tree = [] { return Json{{"study", {{"kind", "p"}}}}; };
  made.rows = [] {
    return std::vector<std::vector<std::string>>{{"a", "b,c"}, {"", "say \"so\""}};
  };
  return made;
}

}  // namespace

TEST_CASE("outputs: each has a name of its own and something to be written of") {
  std::set<std::string> names;
  for (const auto* output : all()) {
    INFO(output->option);
    CHECK(names.insert(output->option).second);
    CHECK_FALSE(output->subjects.empty());
    CHECK(output->option.empty() == output->ending.empty());
    CHECK(output->option.empty() == output->sentence.empty());
  }
}

TEST_CASE("outputs: only those are written that are asked for and belong to the report",
          "[parallel]") {
  const MPI_Comm comm = PETSC_COMM_WORLD;
  const test::TemporaryFolder folder;
  std::string place = linalg::first_text(comm, folder / "");
  std::map<std::string, std::string> files;
  for (const char* name : {"output", "study_csv", "sweep_csv", "trajectory"}) {
    files[name] = place + name;
  }
  write_all(report(Subject::study, comm), files);
  if (linalg::rank(comm) != 0) return;
  CHECK(folder.entries() == 2);
  CHECK(std::filesystem::exists(files["output"]));
  CHECK(test::content(files["study_csv"]) == "a,\"b,c\"\n,\"say \"\"so\"\"\"\n");
}

TEST_CASE("outputs: a summary says where it comes from") {
  const auto made = report(Subject::study, PETSC_COMM_SELF);
  CHECK(Json::parse(test::written(made, "summary"))["provenance"] ==
        Json{{"program", "by hand"}, {"options", {{"mu_d", "0.5"}}}});
}
