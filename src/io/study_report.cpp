#include "stickslip/io/study_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "stickslip/io/hdf5_file.hpp"
#include "stickslip/io/parts.hpp"

namespace stickslip::io {
namespace {

std::string number(double value) {
  if (std::isnan(value)) return fmt::format("{:>17}", "");
  return fmt::format("{:>17.10g}", value);
}

std::string table_text(const studies::Table& table) {
  std::string text = "\n" + table.title + "\n";
  for (const auto& column : table.columns) text += fmt::format("{:>17}", column);
  text += "\n";
  for (const auto& row : table.rows) {
    for (double value : row) text += number(value);
    text += "\n";
  }
  return text;
}

Json run_json(const model::Scene& meant, const studies::Run& run) {
  Json scene = scene_json(meant);
  scene["method"] = run.method;
  for (const auto& [name, value] : run.parameters) scene[name] = value;
  Json cost = seconds_json(run.ledger);
  cost["seconds"] = run.seconds;
  cost["unknowns"] = run.ledger.unknowns;
  cost["factor_megabytes"] = run.ledger.factor_megabytes;
  return {{"scene", scene}, {"results", results_json(run.results)}, {"cost", cost}};
}

Json table_json(const studies::Table& table) {
  Json json{{"title", table.title}};
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    json[table.columns[c]] = column(table.rows, [c](const auto& row) { return row[c]; });
  }
  return json;
}

// Blanks are awkward to type.
std::string table_group(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return "/study/" + hdf5_name(name);
}

}  // namespace

std::string study_table(const options::Request& request, const studies::Study& study,
                        const RunTimes& times) {
  std::string text = scene_line(request.scene);
  for (const auto& table : study.tables) text += table_text(table);
  text += "\n";
  for (const auto& line : study.conclusions) text += line + "\n";
  return text + fmt::format("{} runs, {:.2f} s in all\n", study.runs.size(), times.total);
}

std::string study_summary(MPI_Comm comm, const options::Request& request,
                          const studies::Study& study, const RunTimes& times) {
  Json json;
  json["scene"] = scene_json(request.scene);
  json["runs"] = Json::array();
  for (const auto& run : study.runs) json["runs"].push_back(run_json(request.scene, run));
  json["study"]["kind"] = study.kind;
  for (const auto& table : study.tables) json["study"]["tables"][table.name] = table_json(table);
  json["study"]["conclusions"] = study.conclusions;
  json["cost"]["seconds"] = times.total;
  json["provenance"] = provenance_json(comm, request);
  return json.dump(2) + "\n";
}

std::string study_csv(const studies::Study& study) {
  std::string text =
      "method,parameters,quantity,value,error,seconds,assembly,analysis,factorization,solve,"
      "megabytes\n";
  for (const auto& run : study.runs) {
    std::string parameters;
    for (const auto& [name, value] : run.parameters) {
      parameters += fmt::format("{}{}={:.17g}", parameters.empty() ? "" : ";", name, value);
    }
    const auto& l = run.ledger;
    for (const auto& result : run.results) {
      text += fmt::format("{},{},{},{:.17g},{:.3g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:g}\n",
                          run.method, parameters, result.key, result.value[0], result.error[0],
                          run.seconds, l.assembly_seconds, l.analysis_seconds,
                          l.factorization_seconds, l.solve_seconds, l.factor_megabytes);
    }
  }
  return text;
}

void write_study_hdf5(MPI_Comm comm, const options::Request& request, const studies::Study& study,
                      const RunTimes& times) {
  Hdf5File file(comm, request.output.output);
  file.make_group("/study");
  file.attribute("/study", "kind", study.kind);
  for (const auto& table : study.tables) {
    const std::string group = table_group(table.name);
    file.make_group(group);
    file.attribute(group, "title", table.title);
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      file.write_array(group + "/" + table.columns[c],
                       column(table.rows, [c](const auto& row) { return row[c]; }));
    }
  }
  write_record(file, comm, request, times);
  file.commit();
}

}  // namespace stickslip::io
