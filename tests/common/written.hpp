#pragma once
/// What outputs write of a report.

#include <stdexcept>
#include <string>

#include "stickslip/cli/output.hpp"
#include "temporary.hpp"

namespace stickslip::test {

/// Writes the output of that option to a file.
inline void write(const cli::Report& report, const std::string& option, const std::string& file) {
  for (const auto* output : cli::all()) {
    if (output->option == option) return output->write(report, file);
  }
  throw std::invalid_argument("no output: " + option);
}

/// What it holds then.
inline std::string written(const cli::Report& report, const std::string& option) {
  const TemporaryFolder folder;
  write(report, option, folder / "file");
  return content(folder / "file");
}

}  // namespace stickslip::test
