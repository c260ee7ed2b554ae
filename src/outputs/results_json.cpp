#include "stickslip/outputs/results_json.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace stickslip::outputs {

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

}  // namespace

quantities::Results results_of(const Json& json) {
  quantities::Results results;
  for (const auto& [key, result] : json.items()) results.push_back(result_of(key, result));
  return results;
}

}  // namespace stickslip::outputs
