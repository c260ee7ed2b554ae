#include "stickslip/outputs/results_json.hpp"

#include <nlohmann/json.hpp>

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
    if (r.ci95.empty()) continue;
    json[r.key]["ci95"] = r.is_scalar() ? Json(r.ci95[0]) : Json(r.ci95);
  }
  return json;
}

}  // namespace stickslip::outputs
