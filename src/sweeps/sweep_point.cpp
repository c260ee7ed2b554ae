#include "stickslip/sweeps/sweep_point.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "stickslip/accuracy/carry_out.hpp"
#include "stickslip/io/parts.hpp"
#include "stickslip/petsc/check.hpp"
#include "stickslip/petsc/solver_statistics.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::sweeps {
namespace {

using outputs::Json;

constexpr std::array kStatuses{Status::reached, Status::not_reached, Status::failed,
                               Status::no_memory, Status::refused};

Status status_named(const std::string& text) {
  for (Status status : kStatuses) {
    if (text == status_text(status)) return status;
  }
  throw std::invalid_argument("no status of a run: " + text);
}

Json head(std::size_t point, Status status, const std::string& message) {
  Json json{{"point", point}, {"status", status_text(status)}};
  if (!message.empty()) json["message"] = message;
  return json;
}

Json outcome_of(MPI_Comm comm, const cases::Case& given, std::size_t point) {
  const double start = petsc::wall_seconds();
  try {
    const auto outcome = accuracy::carry_out(comm, given, {});
    Json json =
        head(point, outcome.reached ? Status::reached : Status::not_reached, outcome.shortfall);
    json.update(io::run_json(given, outcome, {0, petsc::wall_seconds() - start}));
    return json;
  } catch (...) {
    const Failure failure = petsc::failure_in_flight();
    const bool memory = failure.status() == ExitStatus::no_memory;
    Json json = head(point, memory ? Status::no_memory : Status::failed, failure.what());
    json["scene"] = io::scene_json(given.scene);
    json["results"] = Json::object();
    json["cost"]["seconds"] = petsc::wall_seconds() - start;
    return json;
  }
}

}  // namespace

const char* status_text(Status status) {
  switch (status) {
  case Status::reached: return "reached";
  case Status::not_reached: return "not reached";
  case Status::failed: return "failed";
  case Status::no_memory: return "no memory";
  case Status::refused: return "refused";
  }
  return "";
}

SweepPoint compute_run(MPI_Comm comm, const options::Request& given, std::size_t point) {
  Json json = outcome_of(comm, given, point);
  json["warnings"] = given.warnings;
  return read_run(json.dump());
}

SweepPoint refused_run(std::size_t point, const std::string& reason) {
  Json json = head(point, Status::refused, reason);
  json["scene"] = json["results"] = Json::object();
  json["cost"]["seconds"] = 0;
  return read_run(json.dump());
}

SweepPoint read_run(std::string entry) {
  const Json json = Json::parse(entry);
  SweepPoint run;
  const Json& point = json.at("point");
  if (!point.is_number_unsigned()) throw std::invalid_argument("no number of a point");
  run.point = point.get<std::size_t>();
  run.status = status_named(json.at("status").get<std::string>());
  run.message = json.value("message", "");
  run.results = outputs::results_of(json.at("results"));
  (void)json.at("scene");
  run.seconds = json.at("cost").at("seconds").get<double>();
  run.entry = std::move(entry);
  return run;
}

}  // namespace stickslip::sweeps
