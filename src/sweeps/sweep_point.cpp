#include "stickslip/sweeps/sweep_point.hpp"

#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "stickslip/accuracy/refinement.hpp"
#include "stickslip/io/parts.hpp"
#include "stickslip/petsc/solver_statistics.hpp"
#include "stickslip/support/errors.hpp"

namespace stickslip::sweeps {
namespace {

using io::Json;

constexpr std::array kStatuses{Status::reached, Status::not_reached, Status::failed,
                               Status::no_memory};

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

// JSON has no word for what is not finite.
double number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

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

void require_equal_sizes(const quantities::Result& r) {
  const std::size_t size = r.is_scalar() ? 1 : r.abscissa.size();
  const bool intervals = r.ci95.empty() || r.ci95.size() == size;
  if (intervals && r.value.size() == size && r.error.size() == size) return;
  throw std::invalid_argument("values, errors and arguments differ in number: " + r.key);
}

quantities::Result result_of(const std::string& key, const Json& json) {
  quantities::Result result;
  if (!json.is_object() || json.empty()) throw std::invalid_argument("no result: " + key);
  const bool scalar = json.begin().key() == "value";
  result.key = key;
  result.unit = json.value("unit", "");
  if (!scalar) {
    result.abscissa_name = json.begin().key();
    result.abscissa = numbers(json.begin().value());
  }
  result.value = numbers(json.at("value"));
  result.error = numbers(json.at("error"));
  if (json.contains("ci95")) result.ci95 = intervals(json["ci95"], scalar);
  require_equal_sizes(result);
  return result;
}

Json entry_of(MPI_Comm comm, const cases::Case& given, std::size_t point) {
  const double start = petsc::wall_seconds();
  try {
    const auto outcome = accuracy::refine(comm, given, {});
    Json json =
        head(point, outcome.reached ? Status::reached : Status::not_reached, outcome.shortfall);
    json.update(io::run_json(given, outcome, {0, petsc::wall_seconds() - start}));
    return json;
  } catch (const Failure& failure) {
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
  }
  return "";
}

SweepPoint compute_run(MPI_Comm comm, const cases::Case& given, std::size_t point) {
  return read_run(entry_of(comm, given, point).dump());
}

SweepPoint read_run(std::string entry) {
  const Json json = Json::parse(entry);
  SweepPoint run;
  const Json& point = json.at("point");
  if (!point.is_number_unsigned()) throw std::invalid_argument("no number of a point");
  run.point = point.get<std::size_t>();
  run.status = status_named(json.at("status").get<std::string>());
  run.message = json.value("message", "");
  for (const auto& [key, result] : json.at("results").items()) {
    run.results.push_back(result_of(key, result));
  }
  (void)json.at("scene");
  run.seconds = json.at("cost").at("seconds").get<double>();
  run.entry = std::move(entry);
  return run;
}

}  // namespace stickslip::sweeps
