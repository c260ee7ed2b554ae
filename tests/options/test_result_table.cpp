#include "../common/catch.hpp"
#include "stickslip/options/result_table.hpp"

#include <cstddef>
#include <set>
#include <sstream>
#include <stdexcept>

#include "../common/temporary.hpp"
#include "stickslip/options/manual.hpp"

using namespace stickslip;
using namespace stickslip::options;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// How many cells a line of a Markdown table has; 0 for any other line.
std::ptrdiff_t cells_in(const std::string& line) {
  if (!line.starts_with('|')) return 0;
  std::ptrdiff_t bars = 0;
  for (std::size_t n = 1; n < line.size(); ++n) bars += line[n] == '|' && line[n - 1] != '\\';
  return bars;
}

}  // namespace

TEST_CASE("result table: keys are unique, every result has a symbol and a definition") {
  std::set<std::string> keys;
  for (const auto& row : result_table()) {
    INFO(row.key);
    CHECK(keys.insert(row.key).second);
    CHECK_FALSE(row.symbol.empty());
    CHECK_FALSE(row.definition.empty());
    CHECK(find_result(row.key) == &row);
  }
}

TEST_CASE("result table: results of observables and derivatives are found by their patterns") {
  const auto pattern = [](const char* key) {
    const ResultRow* row = find_result(key);
    return row == nullptr ? std::string() : row->key;
  };
  CHECK(pattern("pi(v^2)") == "pi(f)");
  CHECK(pattern("pi(|v|)") == "pi(f)");
  CHECK(pattern("pi(|v||stick)") == "pi(f|stick)");
  CHECK(pattern("pi(abs(v)>0.5|slide)") == "pi(f|slide)");
  CHECK(pattern("w_plus(x*(1+v))") == "w_plus(f)");
  CHECK(pattern("stationary(1)") == "stationary(f)");
  CHECK(pattern("dP_stick_dmu_d") == "dA_dp");
  CHECK(pattern("dE_V2_dmu_d_minus") == "dA_dp");
  CHECK(pattern("dE_X2_ddrag_coefficient") == "dA_dp");
  for (const char* unknown : {"", "foo", "foo(v)", "u(v|stick)", "pi", "pi(v", "dP_stick_dmu",
                              "dfoo_dtau", "d_dtau", "dS_0_dtau", "P_stick_dtau", "P_stick(v)"}) {
    INFO(unknown);
    CHECK(pattern(unknown).empty());
  }
}

TEST_CASE("result table: units and abscissas by key") {
  CHECK(unit_of("E_V2") == "velocity^2");
  CHECK(unit_of("P_stick").empty());
  CHECK(unit_of("w_one") == "time");
  CHECK(unit_of("u(v^2)").empty());  // that of v^2 is not known
  CHECK(abscissa_of("S_v") == "omega");
  CHECK(abscissa_of("S_0").empty());
  CHECK(abscissa_of("E(v)") == "time");
  CHECK_THROWS_AS(unit_of("P_stik"), std::logic_error);
}

TEST_CASE("result table: the committed page has the tables that the program prints") {
  const std::string page = test::content(std::string(STICKSLIP_SOURCE) + "/docs/quantities.md");
  const std::string begin = "<!-- Printed by stickslip -reference_quantities. -->\n\n",
                    end = "\n<!-- End of what is printed. -->\n";
  const auto first = page.find(begin);
  REQUIRE(first != page.npos);
  const auto last = page.find(end, first);
  REQUIRE(last != page.npos);
  CHECK(page.substr(first + begin.size(), last - first - begin.size()) == quantity_tables());
}

TEST_CASE("reference pages: every row of a table has a cell below each title") {
  for (const std::string& page : {reference_page(), quantity_tables()}) {
    std::ptrdiff_t columns = 0;
    for (const auto& line : lines_of(page)) {
      INFO(line);
      const auto cells = cells_in(line);
      CHECK((columns == 0 || cells == 0 || cells == columns));
      columns = cells;
    }
  }
}
