#include <nlohmann/json.hpp>

#include "stickslip/outputs/report.hpp"
#include "stickslip/support/atomic_file.hpp"

namespace stickslip::outputs {

Json summary_of(const Report& report) {
  Json tree = report.tree();
  Json& provenance = tree["provenance"];
  for (const auto& [name, value] : report.provenance) provenance[name] = value;
  for (const auto& [name, value] : report.options) provenance["options"][name] = value;
  tree["warnings"] = report.warnings;
  return tree;
}

namespace {

void write_summary(const Report& report, const std::string& file) {
  write_text(file, summary_of(report).dump(2) + "\n");
}

}  // namespace

extern const Output kSummary{
    .option = "summary",
    .ending = "json",
    .sentence = "write results, error estimates, cost and provenance as JSON to this file",
    .synonyms = {"json"},
    .subjects = {Subject::run, Subject::study, Subject::sweep, Subject::plan},
    .write = write_summary};

}  // namespace stickslip::outputs
