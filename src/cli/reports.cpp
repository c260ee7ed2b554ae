#include "stickslip/cli/reports.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <petscsys.h>
#include <slepcversion.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include "stickslip/base/text.hpp"
#include "stickslip/case/force_rows.hpp"
#include "stickslip/cli/version.hpp"
#include "stickslip/linalg/session.hpp"
#include "stickslip/model/effect.hpp"
#include "stickslip/model/process.hpp"

namespace stickslip::cli {
namespace {

std::string host() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string mpi_library() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  const std::string all(text.data());
  return all.substr(0, all.find_first_of(",\n"));
}

std::string compiler() {
#ifdef __clang__
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

std::string petsc_version() {
  return fmt::format("{}.{}.{}", PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
}

std::string slepc_version() {
  return fmt::format("{}.{}.{}", SLEPC_VERSION_MAJOR, SLEPC_VERSION_MINOR, SLEPC_VERSION_SUBMINOR);
}

const char* scalar_type() { return linalg::complex_scalars() ? "complex" : "real"; }

Json seconds_json(const linalg::SolverStatistics& statistics) {
  return {{"assembly_seconds", statistics.assembly_seconds},
          {"analysis_seconds", statistics.analysis_seconds},
          {"factorization_seconds", statistics.factorization_seconds},
          {"solve_seconds", statistics.solve_seconds}};
}

Json resolution_json(const run::Resolution& r) {
  Json json{{"scheme", "none"}};
  if (r.scheme == cases::Scheme::hp) {
    json = {{"scheme", "hp"},
            {"degree", r.degree},
            {"layers", r.layers},
            {"noise_degree", r.grouping.degree},
            {"v_max", r.v_max}};
  }
  if (r.scheme == cases::Scheme::upwind) {
    json = {{"scheme", "upwind"}, {"p", r.points}, {"v_max", r.v_max}};
  }
  json["noise_levels"] = r.levels;
  json["noise_nodes"] = r.noise_nodes();
  return json;
}

Json comparison_json(const run::Comparison& comparison, const std::string& compared) {
  Json rows = Json::array();
  for (const auto& c : comparison.rows) {
    const auto& r = c.reference;
    Json row{{"quantity", r.quantity}};
    if (r.argument) row["argument"] = *r.argument;
    row.update({{"value", c.value},
                {"error", c.error},
                {"reference", r.value},
                {"ci95", {r.low, r.high}},
                {"z", c.z},
                {"verdict", verdict_text(c.verdict)}});
    rows.push_back(std::move(row));
  }
  return {{"file", compared},
          {"disagrees", comparison.disagrees},
          {"left_out", comparison.left_out},
          {"rows", std::move(rows)}};
}

Json scene_of(const model::Scene& meant, const run::Outcome& outcome) {
  Json scene = scene_json(meant);
  if (!outcome.steps.empty()) {
    scene["noise_levels"] = outcome.steps.back().resolution.levels;
    const double v_max = outcome.steps.back().resolution.v_max;
    if (v_max > 0) scene["v_max"] = v_max;
  }
  return scene;
}

Json step_of(const run::Step& step) {
  Json json = resolution_json(step.resolution);
  json.update({{"unknowns", step.statistics.unknowns},
               {"nonzeros", step.statistics.nonzeros},
               {"factor_entries", step.statistics.factor_entries},
               {"factor_megabytes", step.statistics.factor_megabytes},
               {"backward_error", step.statistics.backward_error}});
  json.update(seconds_json(step.statistics));
  json["seconds"] = step.seconds;
  for (const auto& check : step.checks) json["checks"][check.name] = check.value;
  if (!step.limiting_key.empty()) {
    json["relative_error"] = step.estimate;
    json["limited_by"] = step.limiting_key;
  }
  return json;
}

Json simulation_of(const run::Simulated& simulated) {
  const auto& s = simulated.state;
  return {{"excursions", s.excursions},
          {"continued_from", simulated.continued_from},
          {"jumps", s.jumps},
          {"seconds", s.seconds}};
}

Json cost_of(const run::Outcome& outcome, const RunTimes& times) {
  Json cost{{"seconds", times.total},
            {"start_up_seconds", times.start_up},
            {"peak_resident_bytes", linalg::peak_resident_bytes()}};
  if (outcome.next_digit_seconds > 0) cost["next_digit_seconds"] = outcome.next_digit_seconds;
  cost.update(seconds_json(outcome.total));
  if (outcome.simulation) cost["simulation"] = simulation_of(*outcome.simulation);
  cost["steps"] = Json::array();
  for (const auto& step : outcome.steps) cost["steps"].push_back(step_of(step));
  return cost;
}

Json plan_of(const linalg::SolverStatistics& total) {
  return {{"assemblies", total.assemblies},
          {"factorizations_real", total.factorizations_real},
          {"factorizations_complex", total.factorizations_complex},
          {"solves", total.solves},
          {"corrections", total.corrections},
          {"iterations", total.iterations},
          {"unknowns", total.unknowns}};
}

// The motion under a given force at the samples.
std::vector<std::vector<std::string>> path_rows(const quantities::Results& results) {
  std::vector<const quantities::Result*> columns;
  for (const auto* row : {&cases::kPathForce, &cases::kPathVelocity, &cases::kPathDisplacement}) {
    columns.push_back(&*std::ranges::find(results, row->key, &quantities::Result::key));
  }
  std::vector<std::vector<std::string>> rows{{"time", "force", "velocity", "displacement"}};
  for (std::size_t n = 0; n < columns[0]->value.size(); ++n) {
    auto& row = rows.emplace_back(1, cell(columns[0]->abscissa[n], 17));
    for (const auto* column : columns) row.push_back(cell(column->value[n], 17));
  }
  return rows;
}

const char* symmetry_name(generator::Symmetry symmetry) {
  switch (symmetry) {
  case generator::Symmetry::even: return "even";
  case generator::Symmetry::odd: return "odd";
  case generator::Symmetry::none: break;
  }
  return "none";
}

std::string system_name(const generator::SystemKey& key) {
  const bool reduced = key.symmetry != generator::Symmetry::none;
  const bool by_time = key.clock == generator::Clock::time;
  const char* const side = key.passage == model::Passage::up     ? "v"
                           : key.passage == model::Passage::down ? "-v"
                                                                 : "|v|";
  const std::string limit =
      std::isinf(key.speed_limit) ? "" : fmt::format(", {} <= {:g}", side, key.speed_limit);
  return fmt::format("{} = {:g}, {}{}", by_time ? "lambda" : "s", key.lambda,
                     reduced ? fmt::format("{} functions", symmetry_name(key.symmetry))
                             : "v of both signs",
                     limit);
}

std::string solves_text(const quantities::Use& use) {
  if (use.forward == 0) return fmt::format("{} transposed", use.transposed);
  return fmt::format("{} forward", use.forward);
}

void add_task(const quantities::Task& task, TextTable& table) {
  std::string name = task.name;
  const auto add = [&](const std::string& system, const std::string& solves) {
    table.add({name, system, solves});
    name.clear();
  };
  for (const auto& use : task.uses) add(system_name(use.system), solves_text(use));
  if (task.derivatives > 0) {
    add("derivatives of its matrix", fmt::format("{} assemblies", task.derivatives));
  }
  if (task.adaptive) {
    add(fmt::format("adaptive: about {} factorisations", task.usual_factorizations),
        fmt::format("about {}", task.usual_solves));
  }
}

std::string tasks_table(const quantities::Plan& plan) {
  if (plan.tasks.empty()) {
    return "sizes only: the linear systems of this solution method, on v of both signs, are not "
           "counted\n";
  }
  TextTable table({{"task", true}, {"linear system", true}, {"solves", true}});
  for (const auto& task : plan.tasks) add_task(task, table);
  return "on each refinement level\n" + table.text() +
         fmt::format("total{}: {} assemblies, {} factorisations, {} solves\n",
                     plan.adaptive() ? ", adaptive tasks not counted" : "", plan.assemblies(),
                     plan.factorizations(), plan.solves());
}

std::string steps_table(const std::vector<run::PredictedStep>& steps) {
  TextTable table({}, 1);
  for (const auto& step : steps) {
    auto cells = size_cells(step.resolution, step.unknowns, step.nonzeros);
    if (step.resolution.scheme != cases::Scheme::none) {
      cells.push_back(
          {{"entries", false, "factor"}, step.fits ? count_text(step.factor_entries) : "-"});
      cells.push_back({{"MB", false, "factors"}, fmt::format("{:.0f}", step.megabytes)});
    }
    // What is not predicted is 0.
    const std::string seconds = step.seconds > 0 ? seconds_text(step.seconds) : "-";
    cells.push_back({{"s", false, "total"}, step.fits ? seconds : "too large"});
    table.add_titled(cells);
  }
  return table.text();
}

Json step_json(const run::PredictedStep& step) {
  Json json = resolution_json(step.resolution);
  json.update({{"unknowns", step.unknowns},
               {"nonzeros", step.nonzeros},
               {"factor_entries", step.factor_entries},
               {"factor_megabytes", step.megabytes},
               {"factor_operations", step.operations},
               {"seconds", step.seconds}});
  return json;
}

Json task_json(const quantities::Task& task) {
  Json json{{"name", task.name}, {"systems", Json::array()}};
  for (const auto& use : task.uses) {
    json["systems"].push_back({{"lambda", use.system.lambda},
                               {"symmetry", symmetry_name(use.system.symmetry)},
                               {"plain_solves", use.forward},
                               {"transposed_solves", use.transposed}});
  }
  json["derivatives"] = task.derivatives;
  json["adaptive"] = task.adaptive;
  return json;
}

std::string text_of(const Request& request, const run::Prediction& prediction) {
  std::string text = scene_text(request.scene) + "\n";
  const auto& plan = prediction.plan;
  if (!run::needs_system(request)) {
    return text + "closed-form results only: no linear system is assembled, factored or solved\n";
  }
  if (request.method.row().simulates) {
    return text + fmt::format("{:g} excursions are simulated; no linear system is assembled\n",
                              request.method.excursions);
  }
  text += tasks_table(plan) + "\n" + steps_table(prediction.steps);
  if (plan.tasks.empty() || !prediction.shortfall.empty()) return text;
  return text +
         fmt::format("about {:.2g} s for these refinement levels; finer ones follow if error "
                     "estimates exceed -accuracy\n",
                     prediction.seconds);
}

Json tree_of(const Request& request, const run::Prediction& prediction) {
  Json tasks = Json::array(), steps = Json::array();
  for (const auto& task : prediction.plan.tasks) tasks.push_back(task_json(task));
  for (const auto& step : prediction.steps) steps.push_back(step_json(step));
  const Json plan{{"tasks", std::move(tasks)},
                  {"assemblies", prediction.plan.assemblies()},
                  {"factorizations", prediction.plan.factorizations()},
                  {"solves", prediction.plan.solves()},
                  {"adaptive", prediction.plan.adaptive()},
                  {"steps", std::move(steps)},
                  {"seconds", prediction.seconds}};
  return {{"scene", scene_json(request.scene)}, {"plan", plan}};
}

// `error` is the number in the next column.
std::string digits_of(double value, double error, run::Digits digits) {
  if (std::isnan(value)) return "";
  switch (digits) {
  case run::Digits::parameter: return fmt::format("{:g}", value);
  case run::Digits::supported: return number_text(value, error);
  case run::Digits::compared: return fmt::format("{:.10g}", value);
  case run::Digits::error: return error_text(value);
  case run::Digits::order: return fmt::format("{:.3f}", value);
  case run::Digits::measurement: break;
  }
  return fmt::format("{:.3g}", value);
}

std::string table_text(const run::Table& table) {
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

Json json_of_run(const model::Scene& meant, const run::Run& run) {
  Json scene = scene_json(meant);
  scene["method"] = run.method;
  for (const auto& [name, value] : run.parameters) scene[name] = value;
  Json cost = seconds_json(run.statistics);
  cost["seconds"] = run.seconds;
  cost["unknowns"] = run.statistics.unknowns;
  cost["factor_megabytes"] = run.statistics.factor_megabytes;
  Json json{{"scene", scene}, {"results", results_json(run.results)}, {"cost", cost}};
  if (!run.failure.empty()) json["message"] = run.failure;
  return json;
}

Json table_json(const run::Table& table) {
  Json json{{"title", table.title}};
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    Json& column = json[table.columns[c].name] = Json::array();
    for (const auto& row : table.rows) column.push_back(row[c]);
  }
  return json;
}

std::string text_of(const Request& request, const run::Study& study, const RunTimes& times) {
  std::string text = scene_text(request.scene);
  for (const auto& table : study.tables) text += table_text(table);
  text += "\n";
  for (const auto& line : study.conclusions) text += line + "\n";
  return text + fmt::format("{} runs, {:.2f} s in total\n", study.runs.size(), times.total);
}

Json tree_of(const Request& request, const run::Study& study, const RunTimes& times) {
  Json tree{{"scene", scene_json(request.scene)}, {"runs", Json::array()}};
  for (const auto& run : study.runs) tree["runs"].push_back(json_of_run(request.scene, run));
  tree["study"]["kind"] = study.kind;
  for (const auto& table : study.tables) tree["study"]["tables"][table.name] = table_json(table);
  tree["study"]["conclusions"] = study.conclusions;
  tree["cost"]["seconds"] = times.total;
  return tree;
}

// Every scalar of every run in a row.
std::vector<std::vector<std::string>> rows_of(const run::Study& study) {
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

std::vector<std::pair<std::string, std::string>> provenance(MPI_Comm comm) {
  return {{"program", "stickslip " + std::string(kVersion)},
          {"commit", kCommit},
          {"scalar", scalar_type()},
          {"petsc", petsc_version()},
          {"slepc", slepc_version()},
          {"mpi", mpi_library()},
          {"blas", linalg::loaded_blas().library},
          {"compiler", compiler()},
          {"host", host()},
          {"ranks", std::to_string(linalg::ranks(comm))},
          {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))}};
}

std::string version_number() { return kVersion; }

std::string version_text() {
  return fmt::format("stickslip {} ({}, {} scalars)\nPETSc {}, SLEPc {}, BLAS {}\n", kVersion,
                     kCommit, scalar_type(), petsc_version(), slepc_version(),
                     linalg::loaded_blas().library);
}

Json scene_json(const model::Scene& s) {
  Json scene;
  for (const auto& [name, value] : effects::parameters_of(s)) {
    std::visit([&, key = name](const auto& one) { scene[key] = one; }, value);
    if (name == "delta") scene["noise_levels_meant"] = s.meant().noise.levels;
  }
  const auto along = model::effective_mu_s(s, false), against = model::effective_mu_s(s, true);
  if (along) scene["mu_s_effective"] = *along;
  if (against && !s.symmetric()) scene["mu_s_minus_effective"] = *against;
  return scene;
}

Report report_from(MPI_Comm comm, const Request& request, Subject subject, const RunTimes& times) {
  Report report;
  report.subject = subject;
  report.comm = comm;
  report.provenance = provenance(comm);
  report.options = request.resolved;
  report.warnings = request.warnings;
  report.seconds = times.total;
  return report;
}

Json run_json(const cases::Case& given, const run::Outcome& outcome, const RunTimes& times,
              const std::string& compared) {
  Json json;
  json["scene"] = scene_of(given.scene, outcome);
  json["results"] = results_json(outcome.results);
  json["accuracy"] = {{"asked", given.question.accuracy}, {"reached", outcome.reached}};
  if (!outcome.reached) json["accuracy"]["shortfall"] = outcome.shortfall;
  if (outcome.comparison) json["comparison"] = comparison_json(*outcome.comparison, compared);
  json["cost"] = cost_of(outcome, times);
  json["plan"] = plan_of(outcome.total);
  return json;
}

Report report_of(MPI_Comm comm, const Request& request, const run::Outcome& outcome,
                 const RunTimes& times) {
  Report report = report_from(comm, request, Subject::run, times);
  report.text = run_table(request, outcome, times);
  report.tree = [&request, &outcome, times] {
    return run_json(request, outcome, times, request.files.compared);
  };
  if (request.question.wants(cases::kGivenForce.quantity)) {
    report.rows = [&outcome] { return path_rows(outcome.results); };
  }
  report.density = outcome.density ? &*outcome.density : nullptr;
  report.speed_error = outcome.speed_error;
  report.modes = outcome.modes;
  report.path = outcome.path ? &*outcome.path : nullptr;
  return report;
}

Report report_of(MPI_Comm comm, const Request& request, const run::Prediction& prediction) {
  Report report = report_from(comm, request, Subject::plan, {});
  report.text = text_of(request, prediction);
  report.tree = [&request, &prediction] { return tree_of(request, prediction); };
  return report;
}

Report report_of(MPI_Comm comm, const Request& request, const run::Study& study,
                 const RunTimes& times) {
  Report report = report_from(comm, request, Subject::study, times);
  report.text = text_of(request, study, times);
  report.tree = [&request, &study, times] { return tree_of(request, study, times); };
  report.rows = [&study] { return rows_of(study); };
  return report;
}

}  // namespace stickslip::cli
