#include "../common/catch.hpp"

#include <cstddef>
#include <sstream>

#include "../common/temporary.hpp"
#include "stickslip/cli/help.hpp"

using namespace stickslip;
using namespace stickslip::cli;

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

TEST_CASE("reference pages: the committed page has the tables that the program prints") {
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

TEST_CASE("reference pages: the committed page of options is the generated one") {
  CHECK(test::content(std::string(STICKSLIP_SOURCE) + "/docs/options.md") == reference_page());
}
