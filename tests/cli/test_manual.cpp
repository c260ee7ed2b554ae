#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "../common/catch.hpp"
#include "stickslip/base/errors.hpp"
#include "stickslip/base/text.hpp"
#include "stickslip/case/entry.hpp"
#include "stickslip/cli/help.hpp"
#include "stickslip/cli/options.hpp"

using namespace stickslip::cli;

namespace {

// The line that holds `part`; empty if none does.
std::string line_with(const std::string& text, const std::string& part) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    if (line.find(part) != std::string::npos) return line;
  }
  return "";
}

// The line after the first one that holds `part`.
std::string line_after(const std::string& text, const std::string& part) {
  const auto end = text.find('\n', text.find(part));
  return text.substr(end + 1, text.find('\n', end + 1) - end - 1);
}

}  // namespace

TEST_CASE("roff: nothing in a text is taken for a command") {
  CHECK(roff("-mu_d 0.25") == "\\-mu_d 0.25");
  CHECK(roff(".5 or 1.") == "\\&.5 or 1.");
  CHECK(roff("'full' `x`") == "\\&\\(aqfull\\(aq \\(gax\\(ga");
  CHECK(roff("v^2 \\ ~1") == "v\\(ha2 \\e \\(ti1");
  CHECK(roff("").empty());
}

TEST_CASE("manual page: every option with its form, unit, range and default") {
  const std::string page = man_page("1.2");
  for (const auto& group : table()) {
    CHECK_THAT(page, Catch::Contains("\n.SS " + roff(group.title) + "\n"));
    for (const auto& option : group.options) {
      INFO(option.name);
      if (swept_by(option) != nullptr) {
        CHECK_THAT(page, Catch::Contains(roff("-" + option.name)));
        continue;
      }
      const auto head = "\n\\fB" + roff("-" + option.name) + "\\fR \\fI" + option.form + "\\fR\n";
      REQUIRE_THAT(page, Catch::Contains(head));
      const auto text = line_after(page, head.substr(1));
      CHECK_THAT(text, Catch::Contains(roff(option.sentence)));
      if (option.kind != Kind::list) {
        for (const auto& word : option.words) CHECK_THAT(text, Catch::Contains(roff(word)));
      }
      if (option.kind == Kind::real || option.kind == Kind::integer) {
        CHECK_THAT(text, Catch::Contains(roff(option.range.text())));
      }
      if (!option.unit.empty()) {
        CHECK_THAT(text, Catch::Contains(fmt::format("[{}]", roff(option.unit))));
      }
      if (!option.initial.empty()) {
        CHECK_THAT(text, Catch::Contains("default " + roff(option.initial) + "."));
      }
    }
  }
}

TEST_CASE("manual page: every form of values, every quantity with its keys") {
  const std::string page = man_page("1.2");
  for (const auto& [form, meaning] : forms()) {
    CHECK_THAT(page, Catch::Contains(fmt::format("\n\\fI{}\\fR\n{}", form, roff(meaning))));
  }
  const auto* quantities = find("quantities");
  for (const auto& word : quantities->words) {
    CHECK_THAT(page, Catch::Contains("\n\\fB" + roff(word) + "\\fR\n"));
  }
  for (const auto* entry : stickslip::cases::entries()) {
    for (const auto* row : entry->rows) {
      CHECK_THAT(page, Catch::Contains(roff(std::string(row->key))));
    }
  }
}

TEST_CASE("manual page: the options outside the table, every exit status, the version, no date") {
  const std::string page = man_page("1.2");
  for (const auto& other : other_options()) {
    CHECK_THAT(page, Catch::Contains("\n\\fB" + roff(other.name) + "\\fR\n"));
  }
  for (const auto& [status, meaning] : stickslip::kExitMeanings) {
    CHECK_THAT(page, Catch::Contains("\\fB" + std::to_string(status) + "\\fR\n" + roff(meaning)));
  }
  CHECK(line_with(page, ".TH") == ".TH STICKSLIP 1 \"\" \"stickslip 1.2\" \"User Commands\"");
}

TEST_CASE("manual page: only its own commands begin a line, and every dash is escaped") {
  std::istringstream lines(man_page("1.2"));
  std::string line;
  while (std::getline(lines, line)) {
    INFO(line);
    REQUIRE_FALSE(line.empty());
    CHECK(line[0] != '\'');
    if (line[0] == '.') {
      const auto name = line.substr(1, line.find(' ') - 1);
      const std::vector<std::string> own{"\\\"", "TH", "SH", "SS", "TP", "PP",
                                         "B",    "I",  "RI", "br", "nh", "ad"};
      CHECK(std::find(own.begin(), own.end(), name) != own.end());
    }
    for (auto dash = line.find('-'); dash != line.npos; dash = line.find('-', dash + 1)) {
      CHECK((dash > 0 && line[dash - 1] == '\\'));
    }
  }
}

TEST_CASE("completion: every option by its name, words and files by the form of the value") {
  const std::string script = completion();
  std::string line = line_with(script, "local names=");
  std::replace(line.begin(), line.end(), '\'', ' ');
  const auto names = stickslip::split(line, ' ');
  for (const auto& name : all_names()) {
    INFO(name);
    CHECK(std::count(names.begin(), names.end(), name) == 1);
  }
  for (const auto& group : table()) {
    for (const auto& option : group.options) {
      INFO(option.name);
      const auto clause = line_with(script, "    -" + option.name + ")");
      REQUIRE_FALSE(clause.empty());
      for (const auto& word : option.words) CHECK_THAT(clause, Catch::Contains(word));
      const bool file = option.kind == Kind::path || option.kind == Kind::input;
      CHECK((clause.find("_stickslip_files") != clause.npos) == file);
    }
  }
  CHECK_THAT(script, Catch::EndsWith("complete -F _stickslip stickslip stickslip-complex\n"));
}
