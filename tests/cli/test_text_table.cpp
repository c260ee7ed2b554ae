#include "../common/catch.hpp"
#include "stickslip/cli/reports.hpp"

using stickslip::cli::spaced;
using stickslip::cli::TextTable;

TEST_CASE("text table: columns are as wide as their widest cell, lines end without blanks") {
  TextTable table({{"name", true}, {"x"}, {"unit", true}});
  table.add({"a", "12.5", "time"});
  table.add({"longer"});
  table.add_line("across all of it, whatever it takes");
  table.add({"b", "1"});
  CHECK(table.text() == "name       x  unit\n"
                        "a       12.5  time\n"
                        "longer\n"
                        "across all of it, whatever it takes\n"
                        "b          1\n");
}

TEST_CASE("text table: titles of two lines, columns one blank apart") {
  TextTable table({{"levels", false, "noise"}, {"s", false, "assembly"}, {"p"}}, 1);
  table.add({"8", "0.5", "16"});
  CHECK(table.text() == " noise assembly\n"
                        "levels        s  p\n"
                        "     8      0.5 16\n");
}

TEST_CASE("text table: parts of a description fill lines of 100 characters") {
  const std::string part(40, 'a');
  CHECK(spaced(std::vector<std::string>{"a = 1", "b = 2"}) == "a = 1   b = 2\n");
  CHECK(spaced(std::vector<std::string>{part, part, "b"}) == part + "   " + part + "   b\n");
  CHECK(spaced(std::vector<std::string>{part, part, std::string(15, 'b')}) ==
        part + "   " + part + "\n" + std::string(15, 'b') + "\n");
  CHECK(spaced(std::vector<std::string>{part, part, std::string(14, 'b')}).size() == 101);
}
