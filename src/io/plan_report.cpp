#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "stickslip/io/parts.hpp"

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
  const bool symmetry_reduced = key.symmetry != operators::Symmetry::none;
  const bool by_time = key.clock == operators::Clock::time;
  return fmt::format("{} = {:g}, {}{}", by_time ? "lambda" : "s", key.lambda,
                     symmetry_reduced ? symmetry_name(key.symmetry) : "both half lines",
                     std::isinf(key.speed_limit) ? "" : ", cut");
}

std::string solves_text(const routes::Use& use) {
  if (use.forward == 0) return fmt::format("{} transposed", use.transposed);
  return fmt::format("{} plain", use.forward);
}

std::string task_lines(const options::Question& question, const routes::Task& task) {
  std::string text;
  std::string name = routes::task_name(question, task);
  const auto line = [&](const std::string& system, const std::string& solves) {
    text += fmt::format("{:<34} {:<28} {}\n", name, system, solves);
    name.clear();
  };
  for (const auto& use : task.uses) line(system_name(use.system), solves_text(use));
  if (task.derivatives > 0) line("its derivatives", fmt::format("{} assemblies", task.derivatives));
  if (task.adaptive) {
    line("its own, by accuracy", fmt::format("usually {} factorisations, {} solves",
                                             task.usual_factorizations, task.usual_solves));
  }
  return text;
}

std::string step_line(const accuracy::PredictedStep& step, std::size_t number) {
  return fmt::format("{:<4} {} {:>14.4g} {:>8.0f} {:>9.3g}\n", number,
                     size_cells(step.resolution, step.unknowns, step.nonzeros), step.factor_entries,
                     step.megabytes, step.seconds);
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

Json task_json(const options::Question& question, const routes::Task& task) {
  Json json{{"name", routes::task_name(question, task)}, {"systems", Json::array()}};
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

}  // namespace

std::string table(const options::Request& request, const accuracy::Prediction& prediction) {
  std::string text = scene_line(request.scene);
  const auto& plan = prediction.plan;
  if (!accuracy::needs_system(request)) {
    return text + "\nclosed formulas only: no system is assembled, factored or solved\n";
  }
  if (request.method.route == options::Route::monte_carlo) {
    return text + fmt::format("\n{:g} excursions are simulated; no system is assembled\n",
                              request.method.excursions);
  }
  text += "\non each discretisation\n";
  for (const auto& task : plan.tasks) text += task_lines(request.question, task);
  if (plan.tasks.empty()) text += "the systems of the route, on both half lines\n";
  text += fmt::format("in all {}{} assemblies, {} factorisations, {} solves\n\n",
                      plan.adaptive() ? "at least " : "", plan.assemblies(), plan.factorizations(),
                      plan.solves());
  text += fmt::format("step {} {:>14} {:>8} {:>9}\n", size_titles(request.method.scheme),
                      "factor entries", "MB", "seconds");
  for (std::size_t n = 0; n < prediction.steps.size(); ++n) {
    text += step_line(prediction.steps[n], n);
  }
  if (plan.tasks.empty()) return text;
  return text + fmt::format("about {:.2g} s for these steps; an accuracy that is missed takes "
                            "more of them\n",
                            prediction.seconds);
}

std::string summary(MPI_Comm comm, const options::Request& request,
                    const accuracy::Prediction& prediction) {
  Json tasks = Json::array(), steps = Json::array();
  for (const auto& task : prediction.plan.tasks) {
    tasks.push_back(task_json(request.question, task));
  }
  for (const auto& step : prediction.steps) steps.push_back(step_json(step));
  const Json plan{{"tasks", std::move(tasks)},
                  {"assemblies", prediction.plan.assemblies()},
                  {"factorizations", prediction.plan.factorizations()},
                  {"solves", prediction.plan.solves()},
                  {"adaptive", prediction.plan.adaptive()},
                  {"steps", std::move(steps)},
                  {"seconds", prediction.seconds}};
  return summary_text(comm, request, {{"scene", scene_json(request.scene)}, {"plan", plan}});
}

}  // namespace stickslip::io
