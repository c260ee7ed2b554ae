#include <set>

#include "../common/catch.hpp"
#include "stickslip/options/settings.hpp"
#include "stickslip/options/table.hpp"
#include "stickslip/support/number_text.hpp"
#include "stickslip/support/text.hpp"

using namespace stickslip;
using namespace stickslip::options;

TEST_CASE("option table: names are unique, defaults obey their own rules") {
  std::set<std::string> names;
  for (const auto& group : table()) {
    for (const auto& option : group.options) {
      INFO(option.name);
      CHECK(names.insert(option.name).second);
      CHECK_FALSE(option.sentence.empty());
      if (option.initial.empty() || option.kind == Kind::text) continue;
      if (option.kind == Kind::real || option.kind == Kind::integer) {
        const auto number = parse_number(option.initial);
        REQUIRE(number);
        CHECK(option.range.contains(*number));
      } else {
        for (const auto& word : split(option.initial, ',')) {
          CHECK(std::find(option.words.begin(), option.words.end(), word) != option.words.end());
        }
      }
    }
  }
}

TEST_CASE("option table: the form of every value is explained") {
  std::set<std::string> explained;
  for (const auto& form : forms()) CHECK(explained.insert(form.name).second);
  std::set<std::string> used;
  for (const auto& option : all_options()) used.insert(option.form);
  CHECK(used == explained);
}

TEST_CASE("option table: what a value must be, and what its form leaves open") {
  const auto check = [](const char* name, const char* must, const char* open) {
    const Option* option = find(name);
    REQUIRE(option != nullptr);
    CHECK(requirement(*option) == must);
    CHECK(allowed(*option) == open);
  };
  check("mu_s", "a number in (0, inf)", "(0, inf)");
  check("noise_levels", "a whole number in [1, 1e+09] or full", "[1, 1e+09], full");
  check("scheme", "hp or upwind", "hp, upwind");
  check("plan", "yes or no", "yes, no");
  check("omega", "numbers in [0, inf) as a,b,c or first:last:count or first:last:count:log",
        "[0, inf)");
  check("output", "a file name", "");
}

TEST_CASE("option table: a sweep is of the option that its name ends with") {
  CHECK(swept_by(*find("sweep_mu_d")) == find("mu_d"));
  CHECK(swept_by(*find("sweep_ranks")) == nullptr);
  CHECK(swept_by(*find("mu_d")) == nullptr);
}

TEST_CASE("ranges: ends belong or not as the text says") {
  const Range open{0, 1, false, false}, closed{0, 1, true, true};
  CHECK_FALSE(open.contains(0));
  CHECK_FALSE(open.contains(1));
  CHECK(open.contains(0.5));
  CHECK(closed.contains(0));
  CHECK(closed.contains(1));
  CHECK_FALSE(closed.contains(1.0000001));
  CHECK(open.text() == "(0, 1)");
  CHECK(closed.text() == "[0, 1]");
  CHECK(Range{}.text() == "(-inf, inf)");
}

TEST_CASE("numbers: decimal and finite, nothing before or after") {
  CHECK(parse_number("0.25") == 0.25);
  CHECK(parse_number("-1e-3") == -1e-3);
  CHECK(parse_number("+2") == 2.0);
  for (const char* bad : {"", "abc", "2.5xyz", "nan", "inf", "1e400", "1,5", " 1", "1 ", "0x10",
                          "--1", "+-1", "1e", "+"}) {
    INFO(bad);
    CHECK_FALSE(parse_number(bad));
  }
}

TEST_CASE("number lists: as they are, or evenly spaced") {
  using Numbers = std::vector<double>;
  CHECK(parse_numbers("0.1") == Numbers{0.1});
  CHECK(parse_numbers("0.1,1,10") == Numbers{0.1, 1, 10});
  CHECK(parse_numbers(" 3 , -1e-2 ") == Numbers{3, -0.01});
  CHECK(parse_numbers("1:2:3") == Numbers{1, 1.5, 2});
  CHECK(parse_numbers("-1:1:2") == Numbers{-1, 1});
  CHECK(parse_numbers("1:16:5:log").value() == Numbers{1, 2, 4, 8, 16});
  const auto many = parse_numbers("0.001:0.1:31:log");
  REQUIRE(many);
  CHECK(many->size() == 31);
  CHECK(many->front() == 0.001);
  CHECK((*many)[15] == Approx(0.01).epsilon(1e-14));
  // Ends are as written, where 0.3 + (0.9 - 0.3) and 0.3 (0.9/0.3) are not 0.9.
  CHECK(parse_numbers("0.3:0.9:4")->back() == 0.9);
  CHECK(parse_numbers("0.3:0.9:4:log")->back() == 0.9);
}

TEST_CASE("number lists: anything else is refused") {
  for (const char* bad :
       {"",          "a",           "1,b",        "1;2",     "1,inf",  "1:2",     "1:2:3:4",
        "1:2:3:lin", "1:2:3:log:5", "1:2:1",      "1:2:0",   "1:2:-3", "1:2:2.5", "2:1:3",
        "1:1:3",     "0:1:3:log",   "-1:1:3:log", "1:2:1e7", "1:x:3",  "nan:1:2", "1:2:3,4"}) {
    INFO(bad);
    CHECK_FALSE(parse_numbers(bad));
  }
}
