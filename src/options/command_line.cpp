#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "reading.hpp"
#include "stickslip/petsc/solver_options.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::options {
namespace {

using petsc::is_option_name;

// A formula such as -v*abs(v) where a value is due, which PETSc takes for an option.
bool is_formula(const std::string& option, const std::string& value) {
  const Option* known = option.starts_with('-') ? find(option.substr(1)) : nullptr;
  if (known == nullptr || known->kind != Kind::text || !is_option_name(value)) return false;
  if (std::isalpha(static_cast<unsigned char>(value[1])) == 0) return false;
  const auto names = all_names();
  return std::count(names.begin(), names.end(), value) == 0;
}

// The same in a line of an options file, in quotes or not: how to write it; empty if nothing is
// wrong.
std::string better_formula(const std::string& line) {
  const auto begin = line.find_first_not_of(" \t"), end = line.find_first_of(" \t", begin);
  const auto start = line.find_first_not_of(" \t", end);
  if (start == line.npos) return "";
  const bool quoted = line[start] == '"';
  const auto first = quoted ? start + 1 : start;
  const auto parts = split(line.substr(first), quoted ? '"' : '#');
  const std::string option = line.substr(begin, end - begin);
  if (line[first] != '-' || !is_formula(option, parts.front())) return "";
  return fmt::format("{} \" {}\"", option, parts.front());
}

// What is wrong with the name of an options file, or with the way to it; empty if nothing is.
// `above` are the files that led to it. It is read twice, here and by PETSc: a pipe would be empty
// then.
std::string unfit_file(const std::string& name, const std::vector<std::string>& above) {
  std::error_code error;
  if (std::find(above.begin(), above.end(), name) != above.end()) {
    return "includes itself; take the inner -options_file out";
  }
  if (!std::filesystem::is_regular_file(name, error) && std::ifstream(name).good()) {
    return "is not a regular file; write the options to a regular file";
  }
  if (std::ifstream(name).good()) return "";
  return "cannot be read; check the name and that you may read it";
}

// The file that a line of an options file includes; nothing if it includes none.
std::optional<std::string> included_file(std::string line) {
  line.erase(std::min(line.find('#'), line.size()));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\t' || c == '\r'; }, ' ');
  std::vector<std::string> words = split(line, ' ');
  std::erase(words, "");
  if (words.empty() || words[0] != "-options_file") return std::nullopt;
  if (words.size() == 1) return "";
  std::erase(words[1], '"');
  return words[1];
}

void check_line(const std::string& line, const std::string& place, Problems& problems) {
  const auto first = line.find_first_not_of(" \t\r");
  if (const auto better = better_formula(line); !better.empty()) {
    problems.add(fmt::format("{}: the value looks like an option; put a blank before it: {}", place,
                             better));
  }
  if (first == line.npos || line[first] == '#' || line[first] == '-') return;
  problems.add(fmt::format("{}: \"{}\" does not start with -name; put a # before comments", place,
                           line.substr(first, 40)));
}

// What is wrong with the encoding of a line; empty if nothing is.
std::string unfit_text(const std::string& line) {
  if (line.starts_with("\xEF\xBB\xBF")) {
    return "begins with a byte order mark; save the file as UTF-8 without one";
  }
  const auto unprintable = [](unsigned char c) { return c < ' ' && c != '\t' && c != '\r'; };
  if (std::none_of(line.begin(), line.end(), unprintable)) return "";
  return "is no text; an options file is text with one -name value a line";
}

void check_options_file(const std::string& name, std::vector<std::string> above,
                        Problems& problems) {
  const std::string unfit = unfit_file(name, above);
  if (!unfit.empty()) return problems.add(fmt::format("-options_file {}: {}", name, unfit));
  if (name.ends_with(".yml") || name.ends_with(".yaml")) return;  // PETSc's YAML reader
  above.push_back(name);
  std::ifstream file(name);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string place = fmt::format("{}:{}", name, number), unfit_line = unfit_text(line);
    if (!unfit_line.empty()) return problems.add(fmt::format("{}: {}", place, unfit_line));
    check_line(line, place, problems);
    if (const auto inner = included_file(line)) check_options_file(*inner, above, problems);
  }
}

}  // namespace

void check_stray_words(const std::vector<std::string>& argv, Problems& problems) {
  for (std::size_t n = 0; n < argv.size(); ++n) {
    const bool is_value = n > 0 && is_option_name(argv[n - 1]);
    const bool after_sign = n > 0 && argv[n - 1] == "=";  // of which the option complains
    if (is_option_name(argv[n]) || is_value || after_sign) continue;
    const bool in_list = argv[n].starts_with(',') || (n > 0 && argv[n - 1].ends_with(','));
    std::error_code error;
    const bool is_file = std::filesystem::is_regular_file(argv[n], error);
    problems.add(fmt::format("{}: belongs to no option; {}", argv[n],
                             in_list         ? "lists have no spaces, as in a,b"
                             : is_file       ? "did you mean -options_file " + argv[n] + "?"
                             : find(argv[n]) ? "did you mean -" + argv[n] + "?"
                                             : "options look like -name value"));
  }
}

void shield_formulas(std::vector<std::string>& argv) {
  for (std::size_t n = 1; n < argv.size(); ++n) {
    if (is_formula(argv[n - 1], argv[n])) argv[n].insert(0, " ");
  }
}

void check_options_files(const std::vector<std::string>& argv) {
  Problems problems;
  for (std::size_t n = 0; n < argv.size(); ++n) {
    if (argv[n] != "-options_file") continue;
    if (n + 1 == argv.size()) {
      problems.add("-options_file: names no file; write -options_file scene.opts");
      break;
    }
    check_options_file(argv[n + 1], {}, problems);
  }
  problems.raise();
}

}  // namespace stickslip::options
