#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <limits>
#include <stdexcept>

#include "stickslip/base/errors.hpp"
#include "stickslip/base/files.hpp"
#include "stickslip/cli/output.hpp"

namespace stickslip::cli {

Json results_json(const quantities::Results& results) {
  Json json = Json::object();
  for (const auto& r : results) {
    if (r.is_scalar()) {
      json[r.key] = {{"value", r.value[0]}, {"error", r.error[0]}};
    } else {
      json[r.key] = {{r.abscissa_name, r.abscissa}, {"value", r.value}, {"error", r.error}};
    }
    if (!r.unit.empty()) json[r.key]["unit"] = r.unit;
    if (!quantities::all_numbers(r) && !r.unreached.empty()) json[r.key]["reason"] = r.unreached;
    if (r.ci95.empty()) continue;
    json[r.key]["ci95"] = r.is_scalar() ? Json(r.ci95[0]) : Json(r.ci95);
  }
  return json;
}

namespace {

double number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

// A scalar is an array of one.
std::vector<double> numbers(const Json& json) {
  if (!json.is_array()) return {number(json)};
  std::vector<double> values;
  for (const auto& value : json) values.push_back(number(value));
  return values;
}

std::vector<std::pair<double, double>> intervals(const Json& json, bool scalar) {
  if (scalar) return {{number(json.at(0)), number(json.at(1))}};
  std::vector<std::pair<double, double>> ends;
  for (const auto& pair : json) ends.emplace_back(number(pair.at(0)), number(pair.at(1)));
  return ends;
}

void require_equal_sizes(const quantities::Result& r, bool scalar) {
  const std::size_t size = scalar ? 1 : r.abscissa.size();
  const bool intervals = r.ci95.empty() || r.ci95.size() == size;
  const bool complete = scalar || !r.abscissa_name.empty();
  if (complete && intervals && r.value.size() == size && r.error.size() == size) return;
  throw std::invalid_argument(r.key + " lacks values, errors or arguments");
}

quantities::Result result_of(const std::string& key, const Json& json) {
  quantities::Result result;
  const bool scalar = !json.at("value").is_array();
  result.key = key;
  result.unit = json.value("unit", "");
  result.value = numbers(json.at("value"));
  result.error = numbers(json.at("error"));
  if (json.contains("ci95")) result.ci95 = intervals(json["ci95"], scalar);
  for (const auto& [name, values] : json.items()) {
    const bool known = name == "value" || name == "error" || name == "ci95";
    if (scalar || known || !values.is_array()) continue;
    result.abscissa_name = name;
    result.abscissa = numbers(values);
  }
  require_equal_sizes(result, scalar);
  return result;
}

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

void print_report(const Report& report, const std::string& /*file*/) { print(report.text); }

void write_summary(const Report& report, const std::string& file) {
  write_text(file, summary_of(report).dump(2) + "\n");
}

}  // namespace

quantities::Results results_of(const Json& json) {
  quantities::Results results;
  for (const auto& [key, result] : json.items()) results.push_back(result_of(key, result));
  return results;
}

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
    .fields = {cases::Quantity::trajectory},
    .write = write_path};

extern const Output kTable{
    .option = {},
    .subjects = {Subject::run, Subject::study, Subject::sweep, Subject::plan},
    .write = print_report};

void print(const std::string& text) {
  const bool printed = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  if (!printed) throw SystemFailure("standard output cannot be written");
}

Json summary_of(const Report& report) {
  Json tree = report.tree();
  Json& provenance = tree["provenance"];
  for (const auto& [name, value] : report.provenance) provenance[name] = value;
  for (const auto& [name, value] : report.options) provenance["options"][name] = value;
  tree["warnings"] = report.warnings;
  return tree;
}

extern const Output kSummary{
    .option = "summary",
    .ending = "json",
    .sentence = "write results, error estimates, cost and provenance as JSON to this file",
    .synonyms = {"json"},
    .subjects = {Subject::run, Subject::study, Subject::sweep, Subject::plan},
    .write = write_summary};

}  // namespace stickslip::cli
