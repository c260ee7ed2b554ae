#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "stickslip/io/parts.hpp"
#include "stickslip/support/number_text.hpp"

namespace stickslip::io {
namespace {

// `error` is the number in the next column.
std::string digits_of(double value, double error, studies::Digits digits) {
  if (std::isnan(value)) return "";
  switch (digits) {
  case studies::Digits::parameter: return fmt::format("{:g}", value);
  case studies::Digits::supported: return number_text(value, error);
  case studies::Digits::compared: return fmt::format("{:.10g}", value);
  case studies::Digits::error: return error_text(value);
  case studies::Digits::order: return fmt::format("{:.3f}", value);
  case studies::Digits::measurement: break;
  }
  return fmt::format("{:.3g}", value);
}

std::string table_text(const studies::Table& table) {
  std::vector<TextTable::Column> titles;
  for (const auto& column : table.columns) titles.push_back({column.name});
  TextTable text(std::move(titles));
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const double next = c + 1 < row.size() ? row[c + 1] : 0;
      cells.push_back(digits_of(row[c], next, table.columns[c].digits));
    }
    text.add(std::move(cells));
  }
  return "\n" + table.title + "\n" + text.text();
}

Json run_json(const model::Scene& meant, const studies::Run& run) {
  Json scene = scene_json(meant);
  scene["method"] = run.method;
  for (const auto& [name, value] : run.parameters) scene[name] = value;
  Json cost = seconds_json(run.statistics);
  cost["seconds"] = run.seconds;
  cost["unknowns"] = run.statistics.unknowns;
  cost["factor_megabytes"] = run.statistics.factor_megabytes;
  Json json{{"scene", scene}, {"results", outputs::results_json(run.results)}, {"cost", cost}};
  if (!run.failure.empty()) json["message"] = run.failure;
  return json;
}

Json table_json(const studies::Table& table) {
  Json json{{"title", table.title}};
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    Json& column = json[table.columns[c].name] = Json::array();
    for (const auto& row : table.rows) column.push_back(row[c]);
  }
  return json;
}

std::string text_of(const options::Request& request, const studies::Study& study,
                    const RunTimes& times) {
  std::string text = scene_text(request.scene);
  for (const auto& table : study.tables) text += table_text(table);
  text += "\n";
  for (const auto& line : study.conclusions) text += line + "\n";
  return text + fmt::format("{} runs, {:.2f} s in total\n", study.runs.size(), times.total);
}

Json tree_of(const options::Request& request, const studies::Study& study, const RunTimes& times) {
  Json tree{{"scene", scene_json(request.scene)}, {"runs", Json::array()}};
  for (const auto& run : study.runs) tree["runs"].push_back(run_json(request.scene, run));
  tree["study"]["kind"] = study.kind;
  for (const auto& table : study.tables) tree["study"]["tables"][table.name] = table_json(table);
  tree["study"]["conclusions"] = study.conclusions;
  tree["cost"]["seconds"] = times.total;
  return tree;
}

// Every scalar of every run in a row.
std::vector<std::vector<std::string>> rows_of(const studies::Study& study) {
  std::vector<std::vector<std::string>> rows{{"method", "parameters", "quantity", "value", "error",
                                              "seconds", "assembly", "analysis", "factorization",
                                              "solve", "megabytes"}};
  for (const auto& run : study.runs) {
    std::string parameters;
    for (const auto& [name, value] : run.parameters) {
      parameters += fmt::format("{}{}={:.17g}", parameters.empty() ? "" : ";", name, value);
    }
    const auto& l = run.statistics;
    for (const auto& r : run.results) {
      rows.push_back({run.method, parameters, r.key, fmt::format("{:.17g}", r.value[0]),
                      fmt::format("{:.3g}", r.error[0]), cell(run.seconds, 6),
                      cell(l.assembly_seconds, 6), cell(l.analysis_seconds, 6),
                      cell(l.factorization_seconds, 6), cell(l.solve_seconds, 6),
                      cell(l.factor_megabytes, 6)});
    }
  }
  return rows;
}

}  // namespace

outputs::Report report_of(MPI_Comm comm, const options::Request& request,
                          const studies::Study& study, const RunTimes& times) {
  outputs::Report report = report_from(comm, request, outputs::Subject::study, times);
  report.text = text_of(request, study, times);
  report.tree = [&request, &study, times] { return tree_of(request, study, times); };
  report.rows = [&study] { return rows_of(study); };
  return report;
}

}  // namespace stickslip::io
