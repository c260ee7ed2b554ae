#include <set>

#include "../common/catch.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/cli/options.hpp"

using namespace stickslip;
using namespace stickslip::cli;

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
