#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "stickslip/io/hdf5_file.hpp"
#include "stickslip/io/parts.hpp"

namespace stickslip::io {
namespace {

std::string table_text(const studies::Table& table) {
  std::string text = "\n" + table.title + "\n";
  for (const auto& column : table.columns) text += fmt::format("{:>17}", column);
  text += "\n";
  for (const auto& row : table.rows) {
    for (double value : row) text += fmt::format("{:>17}", cell(value, 10));
    text += "\n";
  }
  return text;
}

Json run_json(const model::Scene& meant, const studies::Run& run) {
  Json scene = scene_json(meant);
  scene["method"] = run.method;
  for (const auto& [name, value] : run.parameters) scene[name] = value;
  Json cost = seconds_json(run.statistics);
  cost["seconds"] = run.seconds;
  cost["unknowns"] = run.statistics.unknowns;
  cost["factor_megabytes"] = run.statistics.factor_megabytes;
  return {{"scene", scene}, {"results", results_json(run.results)}, {"cost", cost}};
}

Json table_json(const studies::Table& table) {
  Json json{{"title", table.title}};
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    Json& column = json[table.columns[c]] = Json::array();
    for (const auto& row : table.rows) column.push_back(row[c]);
  }
  return json;
}

}  // namespace

std::string table(const options::Request& request, const studies::Study& study,
                  const RunTimes& times) {
  std::string text = scene_line(request.scene);
  for (const auto& table : study.tables) text += table_text(table);
  text += "\n";
  for (const auto& line : study.conclusions) text += line + "\n";
  return text + fmt::format("{} runs, {:.2f} s in all\n", study.runs.size(), times.total);
}

std::string summary(MPI_Comm comm, const options::Request& request, const studies::Study& study,
                    const RunTimes& times) {
  Json tree{{"scene", scene_json(request.scene)}, {"runs", Json::array()}};
  for (const auto& run : study.runs) tree["runs"].push_back(run_json(request.scene, run));
  tree["study"]["kind"] = study.kind;
  for (const auto& table : study.tables) tree["study"]["tables"][table.name] = table_json(table);
  tree["study"]["conclusions"] = study.conclusions;
  tree["cost"]["seconds"] = times.total;
  return summary_text(comm, request, std::move(tree));
}

std::string csv(const studies::Study& study) {
  std::string text =
      "method,parameters,quantity,value,error,seconds,assembly,analysis,factorization,solve,"
      "megabytes\n";
  for (const auto& run : study.runs) {
    std::string parameters;
    for (const auto& [name, value] : run.parameters) {
      parameters += fmt::format("{}{}={:.17g}", parameters.empty() ? "" : ";", name, value);
    }
    const auto& l = run.statistics;
    for (const auto& r : run.results) {
      text += csv_line({run.method, parameters, r.key, fmt::format("{:.17g}", r.value[0]),
                        fmt::format("{:.3g}", r.error[0]), cell(run.seconds, 6),
                        cell(l.assembly_seconds, 6), cell(l.analysis_seconds, 6),
                        cell(l.factorization_seconds, 6), cell(l.solve_seconds, 6),
                        cell(l.factor_megabytes, 6)});
    }
  }
  return text;
}

void write_hdf5(MPI_Comm comm, const options::Request& request, const studies::Study& study,
                const RunTimes& times) {
  Json tree{{"kind", study.kind}};
  for (const auto& table : study.tables) {
    std::string name = table.name;
    std::replace(name.begin(), name.end(), ' ', '_');  // blanks are awkward to type
    tree[name] = table_json(table);
  }
  Hdf5File file(comm, request.output.output);
  write_tree(file, "/study", tree);
  write_record(file, comm, request, times);
  file.commit();
}

}  // namespace stickslip::io
