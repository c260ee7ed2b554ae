#include "../common/catch.hpp"
#include "stickslip/base/text.hpp"

using stickslip::enumerate;
using stickslip::nearest_word;
using stickslip::split;
using stickslip::wrap;

TEST_CASE("nearest word: a slip finds its target, nonsense finds none") {
  const std::vector<std::string> names{"-delta", "-mu_d", "-mu_s", "-tau"};
  CHECK(nearest_word("-detla", names) == "-delta");
  CHECK(nearest_word("-mud", names) == "-mu_d");
  CHECK(nearest_word("-tua", names) == "-tau");
  CHECK(nearest_word("-temperature", names).empty());
}

TEST_CASE("split: trims blanks, keeps empty parts between separators") {
  CHECK(split("", ',').empty());
  CHECK(split("a", ',') == std::vector<std::string>{"a"});
  CHECK(split(" a , b,,c ", ',') == std::vector<std::string>{"a", "b", "", "c"});
}

TEST_CASE("enumerate: commas, then the conjunction") {
  CHECK(enumerate(std::vector<std::string>{"a"}, "or") == "a");
  CHECK(enumerate(std::vector<std::string>{"a", "b", "c"}, "or") == "a, b or c");
}

TEST_CASE("wrap: no line beyond the width, no word lost") {
  const std::string text = "one two three four five six seven eight nine ten";
  const std::string wrapped = wrap(text, 12, 3);
  std::string unwrapped;
  for (const auto& line : split(wrapped, '\n')) {
    CHECK(line.size() <= 12);
    unwrapped += (unwrapped.empty() ? "" : " ") + line;
  }
  CHECK(unwrapped == text);
}

TEST_CASE("wrap: lines are filled to the width, and indented after the first") {
  CHECK(wrap("aa bb cc", 5, 3) == "aa bb\n   cc");
  CHECK(wrap("aa bb cc dd ee", 6, 4) == "aa bb\n    cc dd\n    ee");
  CHECK(wrap("aaaaaaaa b", 4, 1) == "aaaaaaaa\n b");
}

TEST_CASE("nearest word: as many slips as a third of the letters, no more") {
  const std::vector<std::string> names{"-horizon"};
  CHECK(nearest_word("-horixyn", names) == "-horizon");
  CHECK(nearest_word("-hoxxyn", names).empty());
}

TEST_CASE("quoted words: blanks separate, quotes of either kind keep them") {
  using stickslip::quoted_words;
  using Words = std::vector<std::string>;
  CHECK(quoted_words("") == Words{});
  CHECK(quoted_words("  -mu_d 0.5\t-tau 2\r") == Words{"-mu_d", "0.5", "-tau", "2"});
  CHECK(quoted_words("-a 'v^2; stick' -b \"it's\"") == Words{"-a", "v^2; stick", "-b", "it's"});
  CHECK(quoted_words("a'b'\"c d\"e ''") == Words{"abc de", ""});
  CHECK(quoted_words("a \\n") == Words{"a", "\\n"});
  CHECK_FALSE(quoted_words("-a 'b"));
  CHECK_FALSE(quoted_words("-a \"b'"));
}
