#include <algorithm>
#include <nlohmann/json.hpp>

#include "stickslip/catalogue/given_force_keys.hpp"
#include "stickslip/effects/effect.hpp"
#include "stickslip/io/parts.hpp"
#include "stickslip/io/provenance.hpp"
#include "stickslip/model/effective_friction.hpp"
#include "stickslip/petsc/memory.hpp"

namespace stickslip::io {

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

Json seconds_json(const petsc::SolverStatistics& statistics) {
  return {{"assembly_seconds", statistics.assembly_seconds},
          {"analysis_seconds", statistics.analysis_seconds},
          {"factorization_seconds", statistics.factorization_seconds},
          {"solve_seconds", statistics.solve_seconds}};
}

Json resolution_json(const accuracy::Resolution& r) {
  Json json;
  switch (r.scheme) {
  case cases::Scheme::hp:
    json = {{"scheme", "hp"},
            {"degree", r.degree},
            {"layers", r.layers},
            {"noise_degree", r.grouping.degree},
            {"v_max", r.v_max}};
    break;
  case cases::Scheme::upwind:
    json = {{"scheme", "upwind"}, {"p", r.points}, {"v_max", r.v_max}};
    break;
  case cases::Scheme::none: json = {{"scheme", "none"}}; break;
  }
  json["noise_levels"] = r.levels;
  json["noise_nodes"] = r.noise_nodes();
  return json;
}

outputs::Report report_from(MPI_Comm comm, const options::Request& request,
                            outputs::Subject subject, const RunTimes& times) {
  outputs::Report report;
  report.subject = subject;
  report.comm = comm;
  report.provenance = provenance(comm);
  report.options = request.resolved;
  report.warnings = request.warnings;
  report.seconds = times.total;
  return report;
}

namespace {

Json comparison_json(const accuracy::Comparison& comparison, const std::string& compared) {
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

Json scene_of(const model::Scene& meant, const accuracy::Outcome& outcome) {
  Json scene = scene_json(meant);
  if (!outcome.steps.empty()) {
    scene["noise_levels"] = outcome.steps.back().resolution.levels;
    const double v_max = outcome.steps.back().resolution.v_max;
    if (v_max > 0) scene["v_max"] = v_max;
  }
  return scene;
}

Json step_of(const accuracy::Step& step) {
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

Json simulation_of(const monte_carlo::Simulated& simulated) {
  const auto& s = simulated.state;
  return {{"excursions", s.excursions},
          {"continued_from", simulated.continued_from},
          {"jumps", s.jumps},
          {"seconds", s.seconds}};
}

Json cost_of(const accuracy::Outcome& outcome, const RunTimes& times) {
  Json cost{{"seconds", times.total},
            {"start_up_seconds", times.start_up},
            {"peak_resident_bytes", petsc::peak_resident_bytes()}};
  if (outcome.next_digit_seconds > 0) cost["next_digit_seconds"] = outcome.next_digit_seconds;
  cost.update(seconds_json(outcome.total));
  if (outcome.simulation) cost["simulation"] = simulation_of(*outcome.simulation);
  cost["steps"] = Json::array();
  for (const auto& step : outcome.steps) cost["steps"].push_back(step_of(step));
  return cost;
}

Json plan_of(const petsc::SolverStatistics& total) {
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
  for (const auto* row :
       {&catalogue::kPathForce, &catalogue::kPathVelocity, &catalogue::kPathDisplacement}) {
    columns.push_back(&*std::ranges::find(results, row->key, &quantities::Result::key));
  }
  std::vector<std::vector<std::string>> rows{{"time", "force", "velocity", "displacement"}};
  for (std::size_t n = 0; n < columns[0]->value.size(); ++n) {
    auto& row = rows.emplace_back(1, cell(columns[0]->abscissa[n], 17));
    for (const auto* column : columns) row.push_back(cell(column->value[n], 17));
  }
  return rows;
}

}  // namespace

Json run_json(const cases::Case& given, const accuracy::Outcome& outcome, const RunTimes& times,
              const std::string& compared) {
  Json json;
  json["scene"] = scene_of(given.scene, outcome);
  json["results"] = outputs::results_json(outcome.results);
  json["accuracy"] = {{"asked", given.question.accuracy}, {"reached", outcome.reached}};
  if (!outcome.reached) json["accuracy"]["shortfall"] = outcome.shortfall;
  if (outcome.comparison) json["comparison"] = comparison_json(*outcome.comparison, compared);
  json["cost"] = cost_of(outcome, times);
  json["plan"] = plan_of(outcome.total);
  return json;
}

outputs::Report report_of(MPI_Comm comm, const options::Request& request,
                          const accuracy::Outcome& outcome, const RunTimes& times) {
  outputs::Report report = report_from(comm, request, outputs::Subject::run, times);
  report.text = run_table(request, outcome, times);
  report.tree = [&request, &outcome, times] {
    return run_json(request, outcome, times, request.files.compared);
  };
  if (request.question.wants(catalogue::kGivenForce.quantity)) {
    report.rows = [&outcome] { return path_rows(outcome.results); };
  }
  report.density = outcome.density ? &*outcome.density : nullptr;
  report.speed_error = outcome.speed_error;
  report.modes = outcome.modes;
  report.path = outcome.path ? &*outcome.path : nullptr;
  return report;
}

}  // namespace stickslip::io
