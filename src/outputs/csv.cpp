#include <fmt/format.h>

#include "stickslip/outputs/report.hpp"
#include "stickslip/support/atomic_file.hpp"

namespace stickslip::outputs {
namespace {

// RFC 4180: what holds a comma stands in quotes.
std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const auto& text : cells) {
    const bool plain = text.find_first_of(",\"\n") == text.npos;
    std::string inside;
    for (char c : text) inside += c == '"' ? "\"\"" : std::string(1, c);
    line += plain ? text + "," : "\"" + inside + "\",";
  }
  if (!line.empty()) line.pop_back();
  return line + "\n";
}

void write_rows(const Report& report, const std::string& file) {
  std::string text;
  for (const auto& row : report.rows()) text += csv_line(row);
  write_text(file, text);
}

void write_path(const Report& report, const std::string& file) {
  if (report.path == nullptr) {
    if (report.rows) write_rows(report, file);  // of a given force
    return;
  }
  const auto& path = *report.path;
  std::string text = "time,x,y,v\n";
  for (std::size_t n = 0; n < path.time.size(); ++n) {
    text += fmt::format("{:.17g},{:.17g},{:g},{:.17g}\n", path.time[n], path.x[n], path.y[n],
                        path.v[n]);
  }
  write_text(file, text);
}

}  // namespace

extern const Output kStudyCsv{.option = "study_csv",
                              .ending = "csv",
                              .sentence =
                                  "write every scalar of every run of a study as CSV to this file",
                              .subjects = {Subject::study},
                              .write = write_rows};

extern const Output kSweepCsv{
    .option = "sweep_csv",
    .ending = "csv",
    .sentence =
        "write a row for each point of a sweep as CSV to this file: swept values, every scalar and "
        "every number that belongs to a value of an option, such as displacement_cdf(10)[0.1] to "
        "-distance 0.1, with its error estimate, status",
    .subjects = {Subject::sweep},
    .write = write_rows};

extern const Output kTrajectory{
    .option = "trajectory",
    .ending = "csv",
    .sentence = "write the trajectory as CSV with the columns time,x,y,v to this file; that of "
                "-force_file with time,force,velocity,displacement at the samples",
    .subjects = {Subject::run},
    .fields = {catalogue::Quantity::trajectory},
    .write = write_path};

}  // namespace stickslip::outputs
