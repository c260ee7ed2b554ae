#include <cstdio>

#include "stickslip/outputs/report.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::outputs {
namespace {

void print(const Report& report, const std::string& /*file*/) {
  const bool printed = std::fputs(report.text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  if (!printed) throw SystemFailure("standard output cannot be written");
}

}  // namespace

extern const Output kTable{
    .option = {},
    .subjects = {Subject::run, Subject::study, Subject::sweep, Subject::plan},
    .write = print};

}  // namespace stickslip::outputs
