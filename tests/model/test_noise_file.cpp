#include <fstream>

#include "../common/catch.hpp"
#include "../common/temporary.hpp"
#include "stickslip/model/effect.hpp"

using namespace stickslip;

namespace {

std::string complaint(const std::string& rows) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "levels.csv";
  std::ofstream(file) << "# measured\nx,rate_up,rate_down\n" << rows;
  try {
    (void)effects::read_levels(file);
  } catch (const std::invalid_argument& unfit) {
    return unfit.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("noise file: a problem is reported with the line that has it") {
  CHECK(complaint("-1,1,0\n0,1,1\n1,0,1\n") == "nothing");
  CHECK_THAT(complaint("-1,1,0\n0,1,1\n1,zero,1\n"), Catch::StartsWith("line 5: rate_up = zero"));
  CHECK_THAT(complaint("-1,1,0\n\n0,0,1\n1,0,1\n"), Catch::StartsWith("line 5: rate_up = 0"));
  CHECK_THAT(complaint("-1,1,0\n0,1,1\n1,0.5,1\n"), Catch::StartsWith("line 5: rate_up = 0.5"));
}
