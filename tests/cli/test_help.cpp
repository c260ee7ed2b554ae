#include <set>
#include <sstream>

#include "../common/catch.hpp"
#include "stickslip/cli/help.hpp"
#include "stickslip/cli/options.hpp"

using namespace stickslip::cli;

namespace {

std::string on_one_line(const std::string& text) {
  std::istringstream words(text);
  std::string line, word;
  while (words >> word) line += word + " ";
  return line;
}

}  // namespace

TEST_CASE("help: it and the reference page name every option and its default") {
  const std::string help = help_text(), page = reference_page();
  for (const auto& group : table()) {
    for (const auto& option : group.options) {
      CHECK_THAT(help, Catch::Contains("-" + option.name));
      CHECK_THAT(page, Catch::Contains("`-" + option.name + "`"));
      if (!option.initial.empty()) {
        CHECK_THAT(on_one_line(help), Catch::Contains("default " + option.initial));
      }
    }
  }
}

TEST_CASE("help: it fits a terminal of 100 columns") {
  std::istringstream lines(help_text());
  std::string line;
  while (std::getline(lines, line)) {
    INFO(line);
    CHECK(line.size() <= 100);
  }
}

TEST_CASE("help: the form of every value is explained") {
  std::set<std::string> explained;
  for (const auto& [form, meaning] : forms()) CHECK(explained.insert(form).second);
  std::set<std::string> used;
  for (const auto& option : all_options()) used.insert(option.form);
  CHECK(used == explained);
}
