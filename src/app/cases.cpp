#include "cases.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "stickslip/petsc/session.hpp"
#include "stickslip/petsc/solver_options.hpp"
#include "stickslip/support/errors.hpp"
#include "stickslip/support/text.hpp"

namespace stickslip::app {
namespace {

using outputs::Json;
using Words = std::vector<std::string>;

// What a line asks for that is no case: texts, and options that count when the program starts.
void refuse_others(const Words& line) {
  for (const char* word :
       {"-cases", "-help", "--help", "-h", "-version", "--version", "-reference", "-reference_json",
        "-reference_quantities", "-man_page", "-completion", "-help_solvers", "-log_view"}) {
    if (std::find(line.begin(), line.end(), word) == line.end()) continue;
    throw BadInput(fmt::format("{}: is no option of a case; give it to the program", word));
  }
}

Words words_of(const Words& common, const std::string& line) {
  auto own = quoted_words(line);
  if (!own) throw BadInput(fmt::format("{}: a quote is not closed; write \"...\" or '...'", line));
  refuse_others(*own);
  own->insert(own->begin(), common.begin(), common.end());
  options::shield_formulas(*own);
  options::check_options_files(*own);
  return *own;
}

// The summary goes to `answer`, files to where they belong, and nothing else to standard output.
Ending run_line(const Words& common, const std::string& line, const Run& run, Json& answer) {
  try {
    const Words words = words_of(common, line);
    const petsc::OptionsOf options(words);
    (void)petsc::option_value("cases");  // among those of the command line, and used
    return run(words, [&answer](outputs::Report report, const options::Request& request) {
      report.text.clear();
      outputs::write_all(report, request.files.written);
      answer.update(outputs::summary_of(report));
    });
  } catch (const BadInput& bad) {
    return {static_cast<int>(bad.status()), bad.what()};
  }
}

void print(const Json& answer) {
  const std::string line = answer.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const bool printed = std::fputs(line.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  if (!printed) throw SystemFailure("standard output cannot be written");
}

BadInput unreadable(const std::string& file) {
  return BadInput(fmt::format("-cases = {}: cannot be read; name a file of lines such as -mu_d 0.5 "
                              "-tau 2, or - for standard input",
                              file));
}

}  // namespace

int run_cases(const Words& common, const std::string& file, const Run& run) {
  if (petsc::ranks(MPI_COMM_WORLD) > 1) {
    throw BadInput("-cases: runs on one rank; start the program once for each core instead");
  }
  std::ifstream opened;
  if (file != "-") opened.open(file);
  if (file.empty() || !opened) throw unreadable(file);
  std::istream& lines = file == "-" ? std::cin : opened;
  int largest = 0;
  for (std::string line; std::getline(lines, line);) {
    Json answer{{"status", 0}};
    const Ending ending = run_line(common, line, run, answer);
    answer["status"] = ending.status;
    if (!ending.message.empty()) answer["message"] = ending.message;
    print(answer);
    largest = std::max(largest, ending.status);
  }
  if (lines.bad()) throw unreadable(file);  // as a folder is
  return largest;
}

}  // namespace stickslip::app
