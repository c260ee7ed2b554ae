#pragma once
/// Many cases in one process, each with a command line of its own.

#include <functional>
#include <string>
#include <vector>

#include "stickslip/options/request.hpp"
#include "stickslip/outputs/report.hpp"

namespace stickslip::app {

/// How a run ended: its exit status, and what went wrong.
struct Ending {
  int status = 0;
  std::string message = {};
  bool alike = true;  ///< whether all ranks end so
};

/// Takes a report to where it goes. The report refers to what ends after the call.
using Emit = std::function<void(outputs::Report, const options::Request&)>;

/// Runs what the words of a command line and PETSc's options ask for, under a started PETSc.
using Run = std::function<Ending(const std::vector<std::string>& words, const Emit&)>;

/// Runs a case for each line of a file, or of standard input for "-", one after the other: its
/// options are the words `common` and those of the line. Each is answered on standard output by a
/// line of JSON: its exit status, and what -summary writes or what went wrong. A case that fails
/// leaves the others alone. Returns the largest status. Not for several ranks. Throws BadInput
/// where there is no such file.
int run_cases(const std::vector<std::string>& common, const std::string& file, const Run& run);

}  // namespace stickslip::app
