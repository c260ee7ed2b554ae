#include "stickslip/cli/output.hpp"

#include "stickslip/linalg/session.hpp"

namespace stickslip::cli {

extern const Output kSummary, kHdf5, kStudyCsv, kSweepCsv, kTrajectory, kTable;

std::span<const Output* const> all() {
  // The table comes last: where it can be seen, all files are there.
  static constexpr const Output* outputs[] = {&kSummary,  &kHdf5,       &kStudyCsv,
                                              &kSweepCsv, &kTrajectory, &kTable};
  return outputs;
}

void write_all(const Report& report, const std::map<std::string, std::string>& files) {
  const bool first_rank = linalg::rank(report.comm) == 0;
  for (const auto* output : all()) {
    const auto file = files.find(output->option);
    const bool asked = output->option.empty() || file != files.end();
    const bool here = output->collective || first_rank;
    if (!asked || !here || !output->subjects.contains(report.subject)) continue;
    output->write(report, file != files.end() ? file->second : "");
  }
}

}  // namespace stickslip::cli
