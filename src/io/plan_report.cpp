#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "stickslip/io/parts.hpp"
#include "stickslip/support/number_text.hpp"

namespace stickslip::io {
namespace {

const char* symmetry_name(operators::Symmetry symmetry) {
  switch (symmetry) {
  case operators::Symmetry::even: return "even";
  case operators::Symmetry::odd: return "odd";
  case operators::Symmetry::none: break;
  }
  return "none";
}

std::string system_name(const operators::SystemKey& key) {
  const bool reduced = key.symmetry != operators::Symmetry::none;
  const bool by_time = key.clock == operators::Clock::time;
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

std::string steps_table(cases::Scheme scheme, const std::vector<accuracy::PredictedStep>& steps) {
  auto columns = size_columns(scheme);
  const bool system = scheme != cases::Scheme::none;
  if (system) {
    columns.insert(columns.end(), {{"entries", false, "factor"}, {"MB", false, "factors"}});
  }
  columns.push_back({"s", false, "total"});
  TextTable table(std::move(columns), 1);
  for (const auto& step : steps) {
    auto cells = size_cells(step.resolution, step.unknowns, step.nonzeros);
    if (system) {
      cells.push_back(step.fits ? count_text(step.factor_entries) : "-");
      cells.push_back(fmt::format("{:.0f}", step.megabytes));
    }
    // What is not predicted is 0.
    cells.push_back(!step.fits ? "too large" : step.seconds > 0 ? seconds_text(step.seconds) : "-");
    table.add(std::move(cells));
  }
  return table.text();
}

Json step_json(const accuracy::PredictedStep& step) {
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

std::string text_of(const options::Request& request, const accuracy::Prediction& prediction) {
  std::string text = scene_text(request.scene) + "\n";
  const auto& plan = prediction.plan;
  if (!accuracy::needs_system(request)) {
    return text + "closed-form results only: no linear system is assembled, factored or solved\n";
  }
  if (request.method.row().simulates) {
    return text + fmt::format("{:g} excursions are simulated; no linear system is assembled\n",
                              request.method.excursions);
  }
  text += tasks_table(plan) + "\n" + steps_table(request.method.scheme, prediction.steps);
  if (plan.tasks.empty() || !prediction.shortfall.empty()) return text;
  return text +
         fmt::format("about {:.2g} s for these refinement levels; finer ones follow if error "
                     "estimates exceed -accuracy\n",
                     prediction.seconds);
}

Json tree_of(const options::Request& request, const accuracy::Prediction& prediction) {
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

}  // namespace

outputs::Report report_of(MPI_Comm comm, const options::Request& request,
                          const accuracy::Prediction& prediction) {
  outputs::Report report = report_from(comm, request, outputs::Subject::plan, {});
  report.text = text_of(request, prediction);
  report.tree = [&request, &prediction] { return tree_of(request, prediction); };
  return report;
}

}  // namespace stickslip::io
